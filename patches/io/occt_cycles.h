// Groups that contain themselves: damage that sends Open CASCADE's IGES reader into an endless descent.
#pragma once

#include <IGESData_IGESModel.hxx>
#include <optional>

namespace iso::occt {

// The directory number (as in "D127") of a group that is part of itself, at any depth.
std::optional<int> group_within_itself(const Handle(IGESData_IGESModel) & model);

}  // namespace iso::occt
