// What Open CASCADE said about entities of a STEP or IGES file that it could not turn into shapes. It leaves them out without another word;
// here they become problems of the model.
#pragma once

#include <XSControl_WorkSession.hxx>

#include <optional>

#include "patches/brep.h"

namespace iso::occt {

// An entity whose numbers Open CASCADE could not read. It makes geometry of them all the same, from memory that nobody has written: such
// a file is read differently each time. To be asked before the transfer.
struct Unreadable {
  std::string entity, message;
};
std::optional<Unreadable> unreadable_geometry(const Handle(XSControl_WorkSession) & session);

// To be called after the transfer. Faces, shells and other topology that is left out: dropped, with the reason if the surface is at fault.
// Entities that break the format, or curves and surfaces that cannot be made: notes (a face that needs them is dropped on its own).
void report_checks(const Handle(XSControl_WorkSession) & session, Model& model);

}  // namespace iso::occt
