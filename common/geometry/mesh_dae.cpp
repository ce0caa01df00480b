// SPDX-License-Identifier: Apache-2.0
// COLLADA: only geometry and nodes are passed to the import library; materials, animations, skins
// and all other elements are removed.
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "common/geometry/mesh_check.hpp"
#include "common/geometry/mesh_text.hpp"

namespace handsel::mesh {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr int kMaxDepth = 64;
constexpr std::size_t kMaxNodes = 100'000;  // max nodes after expansion of every instance_node
constexpr std::size_t kMaxNodeDepth = 200;

class Document {
 public:
  Document(const fs::path& file, const std::string& content) : file_(file), size_(content.size()) {
    if (xml_.Parse(content.data(), content.size()) != tinyxml2::XML_SUCCESS) {
      const bool deep = xml_.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
      throw ConfigError(file.string() + ":" + std::to_string(xml_.ErrorLineNum()) + ": " +
                        (deep ? "elements are nested deeper than " + std::to_string(kMaxDepth)
                              : "not well-formed XML"));
    }
    root_ = xml_.FirstChildElement("COLLADA");
    if (root_ == nullptr)
      throw ConfigError(file.string() + ": is no DAE: it has no <COLLADA> element");
  }

  std::string checked() {
    leave_out();
    walk(*root_, 1);
    for (const auto& [id, node] : nodes_) expand(*node, 0);
    check_accessors();
    std::size_t all = 0;
    for (const XMLElement* node : top_) all += expand(*node, 0).nodes;
    if (all > kMaxNodes)
      throw ConfigError(file_.string() + ": its nodes name each other, more than 100000 in all");
    tinyxml2::XMLPrinter printer(nullptr, true);
    xml_.Print(&printer);
    return {printer.CStr(), static_cast<std::size_t>(printer.CStrSize() - 1)};
  }

 private:
  [[noreturn]] void fail(const XMLElement& at, const std::string& what) const {
    throw ConfigError(file_.string() + ":" + std::to_string(at.GetLineNum()) + ": " + what);
  }

  void leave_out() {
    static const char* const handled[] = {"asset", "library_geometries", "library_nodes",
                                          "library_visual_scenes", "scene"};
    for (XMLElement *e = root_->FirstChildElement(), *next = nullptr; e != nullptr; e = next) {
      next = e->NextSiblingElement();
      if (std::none_of(std::begin(handled), std::end(handled),
                       [&](const char* name) { return std::string_view(name) == e->Name(); }))
        root_->DeleteChild(e);
    }
  }

  void walk(const XMLElement& e, int depth) {
    if (depth > kMaxDepth) fail(e, "elements are nested deeper than " + std::to_string(kMaxDepth));
    const std::string_view name = e.Name();
    if (const char* count = e.Attribute("count")) {
      const auto value = whole_of(count);
      if (!value || *value < 0 || static_cast<std::size_t>(*value) > size_)
        fail(e, "count is " + shown(count) + ", must be a whole number that fits the file's " +
                    std::to_string(size_) + " bytes");
    }
    if (name == "node") {
      if (const char* id = e.Attribute("id"); id != nullptr && !nodes_.emplace(id, &e).second)
        fail(e, "node " + shown(id) + " is there twice");
      if (std::string_view(e.Parent()->Value()) != "node") top_.push_back(&e);
    } else if (name == "float_array") {
      read_array(e);
    } else if (name == "accessor") {
      accessors_.push_back(&e);
    } else if (name == "p" || name == "vcount") {
      check_whole(e);
    } else if (name == "matrix" || name == "translate" || name == "rotate" || name == "scale" ||
               name == "skew" || name == "lookat") {
      check_numbers(e);
    } else if (name == "instance_controller") {
      fail(e, "a skinned body (instance_controller); a mesh here is rigid");
    }
    for (const XMLElement* child = e.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      walk(*child, depth + 1);
  }

  /// Calls `each` with every word of the element's text.
  template <class Each>
  std::size_t words(const XMLElement& e, const Each& each) const {
    std::string_view text = e.GetText() != nullptr ? e.GetText() : "";
    std::size_t count = 0;
    constexpr std::string_view kBlank = " \t\r\n";
    while (true) {
      text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
      if (text.empty()) return count;
      const std::string_view word = text.substr(0, text.find_first_of(kBlank));
      text.remove_prefix(word.size());
      each(word);
      ++count;
    }
  }

  std::size_t check_numbers(const XMLElement& e) const {
    return words(e, [&](std::string_view word) {
      if (!coordinate_of(word))
        fail(e, "a number is " + shown(word) + ", not finite or no number up to 1e9");
    });
  }

  void read_array(const XMLElement& e) {
    const std::size_t count = check_numbers(e);
    if (const char* said = e.Attribute("count");
        said != nullptr && whole_of(said) != static_cast<long long>(count))
      fail(e, "count is " + shown(said) + ", but there are " + std::to_string(count) + " numbers");
    if (const char* id = e.Attribute("id")) arrays_[id] = count;
  }

  void check_whole(const XMLElement& e) const {
    words(e, [&](std::string_view word) {
      const auto value = whole_of(word);
      if (!value || *value < 0 || static_cast<std::size_t>(*value) > size_)
        fail(e, "an index is " + shown(word) + ", out of range");
    });
  }

  void check_accessors() const {
    for (const XMLElement* e : accessors_) {
      const char* source = e->Attribute("source");
      const auto array =
          source != nullptr && *source == '#' ? arrays_.find(source + 1) : arrays_.end();
      if (array == arrays_.end()) continue;  // array of names, which is not used
      const auto number = [&](const char* key, long long otherwise) {
        const char* text = e->Attribute(key);
        const auto value = text == nullptr ? std::optional(otherwise) : whole_of(text);
        if (!value || *value < 0 || static_cast<std::size_t>(*value) > size_)
          fail(*e, std::string(key) + " of an accessor cannot be " + shown(text));
        return *value;
      };
      long long parameters = 0;
      for (const XMLElement* p = e->FirstChildElement("param"); p != nullptr;
           p = p->NextSiblingElement("param"))
        ++parameters;
      const long long stride = number("stride", 1),
                      reads = number("offset", 0) + number("count", 0) * stride;
      if (stride < 1 || parameters > stride || reads > static_cast<long long>(array->second))
        fail(*e, "an accessor reads " + std::to_string(reads) + " numbers, but its array has " +
                     std::to_string(array->second));
    }
  }

  struct Tree {
    std::size_t nodes{1}, depth{1};
  };

  /// Returns size and depth of the tree at this node, with instantiated nodes expanded.
  Tree expand(const XMLElement& node, std::size_t depth) {
    if (depth > kMaxNodeDepth)
      fail(node, "nodes are nested deeper than 200, or name each other in a circle");
    if (const auto known = trees_.find(&node); known != trees_.end()) return known->second;
    Tree tree;
    const auto add = [&](const Tree& part) {
      tree = {std::min(tree.nodes + part.nodes, kMaxNodes + 1),
              std::max(tree.depth, part.depth + 1)};
      if (tree.depth > kMaxNodeDepth) fail(node, "nodes are nested deeper than 200");
    };
    for (const XMLElement* e = node.FirstChildElement(); e != nullptr;
         e = e->NextSiblingElement()) {
      const std::string_view name = e->Name();
      if (name == "node") add(expand(*e, depth + 1));
      if (name != "instance_node") continue;
      const char* url = e->Attribute("url");
      const auto named = url != nullptr && *url == '#' ? nodes_.find(url + 1) : nodes_.end();
      if (named != nodes_.end()) add(expand(*named->second, depth + 1));
    }
    return trees_[&node] = tree;
  }

  const fs::path& file_;
  std::size_t size_;
  tinyxml2::XMLDocument xml_;
  XMLElement* root_{nullptr};
  std::map<std::string, const XMLElement*, std::less<>> nodes_;
  std::map<std::string, std::size_t, std::less<>> arrays_;
  std::map<const XMLElement*, Tree> trees_;
  std::vector<const XMLElement*> accessors_, top_;
};

}  // namespace

std::string checked_dae(const fs::path& file, const std::string& content) {
  return Document(file, content).checked();
}

}  // namespace handsel::mesh
