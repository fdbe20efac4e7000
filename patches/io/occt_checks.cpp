#include "patches/io/occt_checks.h"

#include <fmt/format.h>

#include <IGESData_IGESEntity.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_InterfaceModel.hxx>
#include <StepGeom_Surface.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TCollection_HAsciiString.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <cctype>

namespace iso::occt {
namespace {

using Entity = Handle(Standard_Transient);

// "#243" in STEP, "D15" in IGES; empty for what concerns the file as a whole.
std::string label_of(const Handle(Interface_InterfaceModel) & model, const Entity& entity) {
  if (entity.IsNull() || model->Number(entity) == 0) return {};
  return model->StringLabel(entity)->ToCString();
}

// "StepShape_AdvancedFace" without its package.
std::string type_of(const Entity& entity) {
  const std::string name = entity->DynamicType()->Name();
  return name.substr(name.find('_') + 1);
}

std::string trimmed(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.erase(text.begin());
  return text;
}

struct Checks {
  const Handle(Interface_InterfaceModel) model;
  Interface_CheckIterator list;

  // The iterator knows the entity itself or its number.
  Entity entity() const {
    if (!list.Value()->Entity().IsNull()) return list.Value()->Entity();
    const int number = list.Number();
    return number > 0 && number <= model->NbEntities() ? model->Value(number) : Entity();
  }
};

// What was said against the surface of a face, if that is why it is missing.
std::string fault_of_surface(const Entity& face, Checks checks) {
  const auto surface_of = Handle(StepShape_FaceSurface)::DownCast(face);
  if (surface_of.IsNull() || surface_of->FaceGeometry().IsNull()) return {};
  for (checks.list.Start(); checks.list.More(); checks.list.Next())
    if (checks.entity() == surface_of->FaceGeometry() && checks.list.Value()->NbFails() > 0)
      return fmt::format(": its surface ({}) cannot be made from what the file says", type_of(surface_of->FaceGeometry()));
  return {};
}

bool is_left_out(const std::string& message) { return message.find("not mapped") != std::string::npos; }

}  // namespace

void report_checks(const Handle(XSControl_WorkSession) & session, Model& model) {
  // Entities that break the format.
  const auto name = [&](const Entity& entity) {
    const std::string label = label_of(session->Model(), entity);
    return label.empty() ? std::string("file") : fmt::format("{} {}", label, type_of(entity));
  };
  Checks load{session->Model(), session->ModelCheckList()};
  for (load.list.Start(); load.list.More(); load.list.Next())
    for (int i = 1; i <= load.list.Value()->NbFails(); ++i)
      model.report(Problem::Kind::note, name(load.entity()), "not as the format wants it: " + trimmed(load.list.Value()->CFail(i)));

  // Entities that did not become shapes. In IGES every failure stands for one, in STEP a warning says so.
  Checks transfer{session->Model(), session->TransferReader()->TransientProcess()->CheckList(Standard_False)};
  for (transfer.list.Start(); transfer.list.More(); transfer.list.Next()) {
    const Handle(Interface_Check) check = transfer.list.Value();
    const Entity entity = transfer.entity();
    const bool iges = !Handle(IGESData_IGESEntity)::DownCast(entity).IsNull();
    for (int i = 1; i <= check->NbFails(); ++i) {
      const std::string message = trimmed(check->CFail(i));
      model.report(iges || is_left_out(message) ? Problem::Kind::dropped : Problem::Kind::note, name(entity), message);
    }
    for (int i = 1; i <= check->NbWarnings(); ++i)
      if (is_left_out(check->CWarning(i)))
        model.report(Problem::Kind::dropped, name(entity),
                     "Open CASCADE makes no shape of it" + (entity.IsNull() ? std::string() : fault_of_surface(entity, transfer)));
  }
}

}  // namespace iso::occt
