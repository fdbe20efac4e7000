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
#include <vector>

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

struct Said {
  Entity entity;
  Handle(Interface_Check) check;
};

// The list as values: copies of its iterator share one position.
std::vector<Said> all_of(Interface_CheckIterator list, const Handle(Interface_InterfaceModel) & model) {
  std::vector<Said> all;
  for (list.Start(); list.More(); list.Next()) {
    Said said{list.Value()->Entity(), list.Value()};  // or the entity's number is known
    if (said.entity.IsNull() && list.Number() > 0 && list.Number() <= model->NbEntities()) said.entity = model->Value(list.Number());
    all.push_back(said);
  }
  return all;
}

// What was said against the surface of a face, if that is why it is missing.
std::string fault_of_surface(const Entity& entity, const std::vector<Said>& all) {
  const auto face = Handle(StepShape_FaceSurface)::DownCast(entity);
  if (face.IsNull() || face->FaceGeometry().IsNull()) return {};
  for (const Said& said : all)
    if (said.entity == face->FaceGeometry() && said.check->NbFails() > 0)
      return fmt::format(": its surface ({}) cannot be made from what the file says", type_of(face->FaceGeometry()));
  return {};
}

// "#243 AdvancedFace".
std::string name_of(const Handle(Interface_InterfaceModel) & model, const Entity& entity) {
  const std::string label = label_of(model, entity);
  return label.empty() ? std::string("file") : fmt::format("{} {}", label, type_of(entity));
}

bool holds(const std::string& text, const char* part) { return text.find(part) != text.npos; }

// Messages after which members of an entity keep what their memory held before, or whole entities are passed over.
bool leaves_numbers_unset(const Entity& entity, const std::string& message) {
  const std::string type = entity.IsNull() ? "" : entity->DynamicType()->Name();
  if (entity.IsNull() || type.starts_with("Interface_")) return holds(message, "Incorrect syntax");
  const bool geometry = type.starts_with("StepGeom_") || type.starts_with("StepShape_");
  const bool measure = type.starts_with("StepBasic_") || type.starts_with("StepRepr_");
  if ((geometry || measure) && (holds(message, "not a Real") || holds(message, "not an Integer"))) return true;
  return geometry && (holds(message, "Count of Parameters is not") || holds(message, "numeration") ||
                      ((holds(message, "not a Boolean") || holds(message, "not a Logical")) && !holds(message, "set to")));
}

bool is_left_out(const std::string& message) { return holds(message, "not mapped"); }

}  // namespace

std::optional<Unreadable> unreadable_geometry(const Handle(XSControl_WorkSession) & session) {
  for (const Said& said : all_of(session->ModelCheckList(), session->Model()))
    for (int i = 1; i <= said.check->NbFails(); ++i)
      if (leaves_numbers_unset(said.entity, said.check->CFail(i)))
        return Unreadable{label_of(session->Model(), said.entity),
                          (said.entity.IsNull() ? "" : type_of(said.entity) + ": ") + trimmed(said.check->CFail(i))};
  return std::nullopt;
}

void report_checks(const Handle(XSControl_WorkSession) & session, Model& model) {
  // Entities, and lines of an IGES file, that break the format.
  const auto name = [&](const Entity& entity) { return name_of(session->Model(), entity); };
  for (const Said& said : all_of(session->ModelCheckList(), session->Model()))
    for (int i = 1; i <= said.check->NbFails(); ++i) {
      const std::string message = trimmed(said.check->CFail(i));
      if (message.starts_with("Syntax error in IGES file"))
        model.report(Problem::Kind::note, message, "lines that are not as the format wants them");
      else
        model.report(Problem::Kind::note, name(said.entity), "not as the format wants it: " + message);
    }

  // Entities that did not become shapes. In IGES every failure stands for one, in STEP a warning says so.
  const auto transfer = all_of(session->TransferReader()->TransientProcess()->CheckList(Standard_False), session->Model());
  for (const auto& [entity, check] : transfer) {
    const bool iges = !Handle(IGESData_IGESEntity)::DownCast(entity).IsNull();
    for (int i = 1; i <= check->NbFails(); ++i) {
      const std::string message = trimmed(check->CFail(i));
      model.report(iges || is_left_out(message) ? Problem::Kind::dropped : Problem::Kind::note, name(entity), message);
    }
    for (int i = 1; i <= check->NbWarnings(); ++i)
      if (is_left_out(check->CWarning(i)))
        model.report(Problem::Kind::dropped, name(entity), "Open CASCADE makes no shape of it" + fault_of_surface(entity, transfer));
  }
}

}  // namespace iso::occt
