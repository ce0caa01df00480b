// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/commands/command.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "common/messages/names.hpp"

namespace handsel::bridge {
namespace {

using Json = nlohmann::json;
using Refused = std::invalid_argument;

constexpr std::size_t kMaxName = 64;                      // as in idl/ [bytes]
constexpr double kMaxCoordinate = 100.0;                  // [m]
constexpr double kMinDart = 0.1, kMaxDart = 3.0;          // [m/s]
constexpr double kMaxHandTime = 0.5, kMaxLookAway = 30;   // [s]
constexpr double kUsualDart = 1.0, kUsualLookAway = 2.0;  // [m/s], [s]

enum class Use { none, may, must };

/// Fields of a task of one kind.
struct TaskForm {
  TaskKind kind;
  Use object{}, human{}, surface{}, onto{}, value{};
};

constexpr std::array kTaskForms{
    TaskForm{.kind = TaskKind::give, .object = Use::must, .human = Use::may},
    TaskForm{.kind = TaskKind::receive, .object = Use::may, .human = Use::may, .onto = Use::may},
    TaskForm{.kind = TaskKind::pick, .object = Use::must},
    TaskForm{.kind = TaskKind::place, .object = Use::must, .surface = Use::must},
    TaskForm{.kind = TaskKind::clear, .surface = Use::must, .onto = Use::may},
    TaskForm{.kind = TaskKind::tidy, .object = Use::must, .onto = Use::must},
    TaskForm{.kind = TaskKind::regrasp, .object = Use::must},
    TaskForm{.kind = TaskKind::lift, .object = Use::must},
    TaskForm{.kind = TaskKind::go_to, .surface = Use::must},
    TaskForm{.kind = TaskKind::pause},
    TaskForm{.kind = TaskKind::resume},
    TaskForm{.kind = TaskKind::cancel},
    TaskForm{.kind = TaskKind::speed, .value = Use::must}};

struct PersonAction {
  const char* name;
  SimAction action;
};

constexpr std::array kPersonActions{PersonAction{"hand", SimAction::person_hand},
                                    PersonAction{"look_away", SimAction::person_look_away},
                                    PersonAction{"refuse", SimAction::person_refuse},
                                    PersonAction{"leave", SimAction::person_leave},
                                    PersonAction{"dart", SimAction::person_dart},
                                    PersonAction{"freeze", SimAction::person_freeze},
                                    PersonAction{"unfreeze", SimAction::person_unfreeze}};

std::string plain_number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// The fields of one command; each is taken once.
class Fields {
 public:
  explicit Fields(const Json& json) : json_(json) {}

  bool has(const char* field) const { return json_.contains(field); }
  std::string text(const char* field, Use use) {
    if (!wanted(field, use)) return {};
    const Json& value = json_.at(field);
    if (!value.is_string()) throw Refused(quoted(field) + " must be a text");
    std::string text = value;
    const bool printable =
        std::all_of(text.begin(), text.end(), [](unsigned char c) { return c > 0x20 && c < 0x7f; });
    if (text.size() > kMaxName || !printable || (text.empty() && use == Use::must))
      throw Refused(quoted(field) + " must have 1 to " + std::to_string(kMaxName) +
                    " printable characters without spaces");
    return text;
  }
  double number(const char* field, Use use, double low, double high, double usual = 0) {
    if (!wanted(field, use)) return usual;
    return in_range(json_.at(field), field, low, high);
  }
  Vector3 point(const char* field) {
    wanted(field, Use::must);
    const Json& value = json_.at(field);
    if (!value.is_array() || value.size() != 3)
      throw Refused(quoted(field) + " must be a list of three numbers, world frame, in metres");
    Vector3 out;
    for (int i = 0; i < 3; ++i)
      out[i] = in_range(value[static_cast<std::size_t>(i)], field, -kMaxCoordinate, kMaxCoordinate);
    return out;
  }
  void require_nothing_else() const {
    for (const auto& [field, value] : json_.items())
      if (!taken_.contains(field))
        throw Refused(quoted(field.substr(0, kMaxName)) + " is no field of this command");
  }

 private:
  static std::string quoted(const std::string& field) { return "\"" + field + "\""; }
  static double in_range(const Json& value, const char* field, double low, double high) {
    const double number = value.is_number() ? value.get<double>() : NAN;
    if (!(number >= low && number <= high))
      throw Refused(quoted(field) + " must be a number from " + plain_number(low) + " to " +
                    plain_number(high));
    return number;
  }
  bool wanted(const char* field, Use use) {
    if (use == Use::none) return false;
    taken_.insert(field);
    if (has(field)) return true;
    if (use == Use::must) throw Refused("the field " + quoted(field) + " is missing");
    return false;
  }

  const Json& json_;
  std::set<std::string, std::less<>> taken_;
};

template <class Table, class Name>
std::string names_in(const Table& table, const Name& name) {
  std::string all;
  for (const auto& row : table) all += (all.empty() ? "" : ", ") + std::string(name(row));
  return all;
}

TaskGoal read_task(Fields& fields) {
  const std::string word = fields.text("task", Use::must);
  const auto form = std::find_if(kTaskForms.begin(), kTaskForms.end(),
                                 [&](const TaskForm& f) { return word == name(f.kind); });
  if (form == kTaskForms.end())
    throw Refused("\"" + word + "\" is no task of the page; there are " +
                  names_in(kTaskForms, [](const TaskForm& f) { return name(f.kind); }));
  TaskGoal goal;
  goal.kind = form->kind;
  goal.object = fields.text("object", form->object);
  goal.human = fields.text("human", form->human);
  goal.surface = fields.text("surface", form->surface);
  goal.onto = fields.text("onto", form->onto);
  goal.value = fields.number("value", form->value, 0, 1);
  return goal;
}

SimControl read_person_action(Fields& fields) {
  SimControl control{.subject = fields.text("person", Use::must)};
  const std::string word = fields.text("action", Use::must);
  const auto row = std::find_if(kPersonActions.begin(), kPersonActions.end(),
                                [&](const PersonAction& action) { return word == action.name; });
  if (row == kPersonActions.end())
    throw Refused("\"" + word + "\" is no action of a simulated person; there are " +
                  names_in(kPersonActions, [](const PersonAction& a) { return a.name; }));
  control.action = row->action;
  switch (row->action) {
    case SimAction::person_hand: {
      const std::string side = fields.text("side", Use::must);
      if (side != "left" && side != "right") throw Refused("\"side\" must be left or right");
      control.side = side == "left" ? Side::left : Side::right;
      control.value = fields.number("time", Use::may, 0, kMaxHandTime, kMaxHandTime);
      control.point = fields.point("point");
      break;
    }
    case SimAction::person_dart:
      control.value = fields.number("speed", Use::may, kMinDart, kMaxDart, kUsualDart);
      break;
    case SimAction::person_look_away:
      control.value = fields.number("time", Use::may, 0, kMaxLookAway, kUsualLookAway);
      break;
    default:
      break;
  }
  return control;
}

}  // namespace

CommandReading read_command(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return {{}, "a command must be a JSON object"};
  Fields fields(json);
  try {
    if (fields.has("task") == fields.has("person"))
      return {{}, "a command must name either a \"task\" or a \"person\""};
    Command command;
    if (fields.has("task"))
      command = read_task(fields);
    else
      command = read_person_action(fields);
    fields.require_nothing_else();
    return {std::move(command), {}};
  } catch (const Refused& refused) {
    return {{}, refused.what()};
  }
}

}  // namespace handsel::bridge
