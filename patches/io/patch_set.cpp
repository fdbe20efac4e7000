#include "patches/io/patch_set.h"

#include "patches/io/read_model.h"
#include "patches/io/text_input.h"

namespace iso {

namespace {

// Mean value coordinates have no first derivatives at the corners, so nothing is proven there of a spline beside a chart.
void refuse_unbounded(const std::string& path, const PatchSet& set) {
  for (std::size_t p = 0; p < set.patches.size(); ++p)
    if (set.patches[p].patch.basis.parameters == SideParameters::mean_value)
      throw Error{.file = path,
                  .place = "patches[" + std::to_string(p) + "]",
                  .message =
                      "parameters by mean value: such a patch can be evaluated, but no bound is known near its corners, so it is "
                      "neither traced nor meshed"};
}

}  // namespace

Model model_of_patches(const std::string& path, const std::string& format, PatchSet set) {
  refuse_unbounded(path, set);
  Model model;
  model.file = path;
  model.format = format;
  model.problems = std::move(set.problems);
  model.parts.push_back(part_of_patches(set.name.empty() ? stem_of(path) : set.name, set.patches));
  Instance instance;
  instance.name = model.parts[0].name;
  model.instances.push_back(std::move(instance));
  return model;
}

namespace {

Result<Model> read_patches(const std::string& path, const char* format, PatchSet (*parse)(const std::string&, std::string_view)) {
  const auto text = read_text(path);
  if (!text) return text.error();
  try {
    return model_of_patches(path, format, parse(path, *text));
  } catch (const Error& error) {
    return error;
  }
}

}  // namespace

Result<Model> read_ipatch(const std::string& path) { return read_patches(path, "IPATCH", parse_ipatch); }
Result<Model> read_gbp(const std::string& path) { return read_patches(path, "GBP", parse_gbp); }
Result<Model> read_lop(const std::string& path) { return read_patches(path, "LOP", parse_lop); }
Result<Model> read_mp(const std::string& path) { return read_patches(path, "MP", parse_mp); }

}  // namespace iso
