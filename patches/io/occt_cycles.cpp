#include "patches/io/occt_cycles.h"

#include <IGESBasic_Group.hxx>
#include <IGESData_IGESEntity.hxx>
#include <vector>

namespace iso::occt {
namespace {

enum class Seen : char { no, open, done };

struct Step {
  int group;
  std::vector<int> parts;
  std::size_t next = 0;
};

}  // namespace

std::optional<int> group_within_itself(const Handle(IGESData_IGESModel) & model) {
  const int count = model->NbEntities();
  const auto group = [&](int n) { return Handle(IGESBasic_Group)::DownCast(model->Entity(n)); };
  const auto parts_of = [&](int n) {
    std::vector<int> parts;
    for (int i = 1; i <= group(n)->NbEntities(); ++i) {
      if (group(n)->Entity(i).IsNull()) continue;
      if (const int part = model->Number(group(n)->Entity(i)); part > 0 && !group(part).IsNull()) parts.push_back(part);
    }
    return parts;
  };

  // Depth first, without recursion: whoever meets a group that is still open has found a ring.
  std::vector<Seen> seen(static_cast<std::size_t>(count) + 1, Seen::no);
  for (int root = 1; root <= count; ++root) {
    if (seen[static_cast<std::size_t>(root)] != Seen::no || group(root).IsNull()) continue;
    std::vector<Step> path{{root, parts_of(root)}};
    seen[static_cast<std::size_t>(root)] = Seen::open;
    while (!path.empty()) {
      Step& step = path.back();
      if (step.next == step.parts.size()) {
        seen[static_cast<std::size_t>(step.group)] = Seen::done;
        path.pop_back();
        continue;
      }
      const int part = step.parts[step.next++];
      Seen& state = seen[static_cast<std::size_t>(part)];
      if (state == Seen::open) return 2 * part - 1;
      if (state == Seen::done) continue;
      state = Seen::open;
      path.push_back({part, parts_of(part)});
    }
  }
  return std::nullopt;
}

}  // namespace iso::occt
