// SPDX-License-Identifier: Apache-2.0
#include "common/config/put_over.hpp"

#include "common/base/errors.hpp"

namespace handsel {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using Places = google::protobuf::TextFormat::ParseInfoTree;

void put(Message& into, const Message& from, const Places* places, const TextPlace& at);

/// Returns the field that names the entries of a list; nullptr if they have no names.
const FieldDescriptor* key_of(const FieldDescriptor& list) {
  const auto* id = list.message_type()->FindFieldByName("id");
  return id != nullptr ? id : list.message_type()->FindFieldByName("source");
}

void put_entries(Message& into, const Message& from, const FieldDescriptor& list,
                 const Places* places, const TextPlace& at) {
  const Reflection& get = *from.GetReflection();
  const FieldDescriptor* key = key_of(list);
  for (int i = 0; i < get.FieldSize(from, &list); ++i) {
    const Message& entry = get.GetRepeatedMessage(from, &list, i);
    Message* target = nullptr;
    if (key != nullptr) {
      const std::string name = entry.GetReflection()->GetString(entry, key);
      if (name.empty())
        throw ConfigError(at.of(list.name(), i) + ": an entry has no " + key->name() +
                          ": it says which entry of the scenario is changed");
      for (int k = 0; target == nullptr && k < get.FieldSize(into, &list); ++k) {
        Message* known = get.MutableRepeatedMessage(&into, &list, k);
        if (known->GetReflection()->GetString(*known, key) == name) target = known;
      }
    }
    if (target == nullptr)
      get.AddMessage(&into, &list)->CopyFrom(entry);
    else
      put(*target, entry, places != nullptr ? places->GetTreeForNested(&list, i) : nullptr,
          at.inside(list.name(), i));
  }
}

void put_values(Message& into, const Message& from, const FieldDescriptor& list) {
  const Reflection& get = *from.GetReflection();
  if (get.FieldSize(from, &list) == 0) return;
  get.ClearField(&into, &list);
  for (int i = 0; i < get.FieldSize(from, &list); ++i)
    get.AddString(&into, &list, get.GetRepeatedString(from, &list, i));
}

void put_value(Message& into, const Message& from, const FieldDescriptor& field) {
  const Reflection& get = *from.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return get.SetDouble(&into, &field, get.GetDouble(from, &field));
    case FieldDescriptor::CPPTYPE_BOOL:
      return get.SetBool(&into, &field, get.GetBool(from, &field));
    case FieldDescriptor::CPPTYPE_ENUM:
      return get.SetEnumValue(&into, &field, get.GetEnumValue(from, &field));
    case FieldDescriptor::CPPTYPE_STRING:
      return get.SetString(&into, &field, get.GetString(from, &field));
    default:
      throw std::logic_error(field.full_name() + " is of a type that no variant can change");
  }
}

void put(Message& into, const Message& from, const Places* places, const TextPlace& at) {
  const Reflection& get = *from.GetReflection();
  for (int i = 0; i < from.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor& field = *from.GetDescriptor()->field(i);
    const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    if (field.is_map()) continue;  // put_over() handles the only map
    if (field.is_repeated() && is_message) {
      put_entries(into, from, field, places, at);
    } else if (field.is_repeated()) {
      put_values(into, from, field);
    } else if (is_message) {
      if (get.HasField(from, &field))
        put(*get.MutableMessage(&into, &field), get.GetMessage(from, &field),
            places != nullptr ? places->GetTreeForNested(&field, -1) : nullptr,
            at.inside(field.name()));
    } else if (places != nullptr && places->GetLocation(&field, -1).line >= 0) {
      put_value(into, from, field);
    }
  }
}

}  // namespace

void put_over(config::Scenario& into, const config::Scenario& from, const Places& places,
              const TextPlace& at) {
  put(into, from, &places, at);
  for (const auto& [joint, position] : from.start()) (*into.mutable_start())[joint] = position;
}

}  // namespace handsel
