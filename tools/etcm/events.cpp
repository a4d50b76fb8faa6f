#include "events.h"

#include <array>
#include <string_view>

#include "etcm/files/record_reader.h"

namespace etcm::cli {

namespace {

struct Form {
  std::string_view name;
  EventKind kind;
  std::size_t fields;
};

constexpr std::array<Form, 5> forms = {{{"join", EventKind::join, 4},
                                        {"leave", EventKind::leave, 2},
                                        {"move", EventKind::move, 4},
                                        {"feature", EventKind::feature, 4},
                                        {"unfeature", EventKind::unfeature, 2}}};

const Form& form_of(const files::RecordReader& reader) {
  for (const Form& form : forms) {
    if (reader.field(0) == form.name) return form;
  }
  reader.fail("no event starts like this; there are join, leave, move, feature and unfeature");
}

}  // namespace

std::string_view name_of(EventKind kind) {
  for (const Form& form : forms) {
    if (form.kind == kind) return form.name;
  }
  return {};
}

std::vector<Event> read_events(const std::string& path, const files::Placement& placement) {
  files::RecordReader reader(path);
  std::vector<Event> events;
  while (reader.next()) {
    const Form& form = form_of(reader);
    reader.expect_fields(form.fields, form.fields, "this " + std::string(form.name));
    Event event;
    event.kind = form.kind;
    event.id = reader.integer(1, "the id");
    event.line_number = reader.line();
    if (form.kind == EventKind::join || form.kind == EventKind::move) {
      event.position = files::place_on_grid(path, reader.line(), reader.number(2, "x"),
                                            reader.number(3, "y"), placement);
    } else if (form.kind == EventKind::feature) {
      event.from = reader.integer(2, "the first node");
      event.to = reader.integer(3, "the second node");
    }
    events.push_back(event);
  }
  return events;
}

}  // namespace etcm::cli
