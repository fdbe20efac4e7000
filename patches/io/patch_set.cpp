#include "patches/io/patch_set.h"

#include "patches/io/read_model.h"
#include "patches/io/text_input.h"

namespace iso {

Model model_of_patches(const std::string& path, const std::string& format, PatchSet set) {
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
