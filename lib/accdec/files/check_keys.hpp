#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/faults.hpp>
#include <accdec/files/keys.hpp>
#include <accdec/files/suggestion.hpp>

// Internal: checks that the tables of a file hold what their keys allow. One check for TOML and JSON.

namespace accdec {

/// Checks trees of nodes, which are TOML's or JSON's. A node knows its type, its place and the words of its format: see
/// TomlNode.
template <class Node>
class KeyCheck {
 public:
  /// @param top  keys of the whole file, where keys may belong that are unknown in a table
  KeyCheck(const std::vector<Key>& top, Faults& faults) : top_(top), faults_(faults) {}

  /// @param label  how messages call the table
  void table(const Node& node, const std::vector<Key>& keys, const std::string& label, const std::string& pointer) {
    bool all_known = true;
    node.for_each_member([&](std::string_view name, const Node& member) {
      if (find_key(keys, name) || faults_.full()) return;
      all_known = false;
      faults_.add(
          member.fault_of_name(pointer + "/" + pointer_step(name), Node::unknown(name, label, hint(name, keys))));
    });
    for (const Key& key : keys) {
      if (faults_.full()) return;
      if (const auto member = node.find(key.name)) {
        value(*member, key, pointer + "/" + key.name);
      } else if (key.required && all_known) {  // the missing key may be the misspelt one
        faults_.add(node.fault(pointer, Node::missing(label, key)));
      }
    }
  }

 private:
  void value(const Node& node, const Key& key, const std::string& at) {
    if (key.nullable && node.is_null()) return;
    switch (key.type) {
      case KeyType::number:
      case KeyType::integer: return number(node, key, Node::subject(key.name), at);
      case KeyType::numbers: return numbers(node, key, at);
      case KeyType::boolean:
        if (!node.is_boolean()) wrong_type(node, key, at, "true or false");
        return;
      case KeyType::text:
      case KeyType::word: return text(node, key, at);
      case KeyType::texts:
      case KeyType::words: return texts(node, key, at);
      case KeyType::table: return inner_table(node, key, at);
      case KeyType::tables: return inner_tables(node, key, at);
    }
  }

  void wrong_type(const Node& node, const Key& key, const std::string& at, std::string_view wanted) {
    faults_.add(node.fault(at, fmt::format("{}must be {}, got {}", Node::subject(key.name), wanted, node.type_name())));
  }

  void number(const Node& node, const Key& key, const std::string& what, const std::string& at) {
    const bool whole = key.type == KeyType::integer;
    if (!(whole ? node.is_integer() : node.is_number())) {
      const std::string wanted = whole ? fmt::format("a whole number, {}", range(key)) : "a number";
      faults_.add(node.fault(at, fmt::format("{}must be {}, got {}", what, wanted, node.type_name())));
      return;
    }
    const double x = node.number();
    if (!std::isfinite(x)) {
      faults_.add(node.fault(at, fmt::format("{}must be finite, got {}; {}", what, x, allowed(key))));
    } else if (!key.range.holds(x)) {
      faults_.add(node.fault(at, fmt::format("{}{} is out of range; {}", Node::equals(what), x, allowed(key))));
    } else if (lost(key, x)) {
      faults_.add(node.fault(at, fmt::format("{}{} is too small: in SI units it cannot be told from 0; {}",
                                             Node::equals(what), x, allowed(key))));
    } else if (key.whole && x != std::floor(x)) {
      faults_.add(node.fault(at, fmt::format("{}{} must be a whole number", Node::equals(what), x)));
    }
  }

  /// Whether it is 0 in SI units, or so small that it has lost digits. Numbers without a unit stay what they are, and
  /// so do those that a program wrote.
  static bool lost(const Key& key, double x) {
    return Node::is_toml && x != 0.0 && !key.unit.empty() &&
           std::abs(to_si(key, x)) < std::numeric_limits<double>::min();
  }

  static std::string allowed(const Key& key) { return key.allowed.empty() ? key.range.text(key.name) : key.allowed; }
  /// "0 <= key <= 9"
  static std::string range(const Key& key) {
    return key.range.text(key.name).substr(std::string_view("allowed is ").size());
  }

  void numbers(const Node& node, const Key& key, const std::string& at) {
    if (key.lone && node.is_number()) return number(node, one_of(key), Node::subject(key.name), at);
    if (!node.is_list())
      return wrong_type(node, key, at, key.lone ? "a number or an array of numbers" : "an array of numbers");
    const std::size_t n = node.size();
    if (n < key.least || (key.most > 0 && n > key.most)) {
      const std::string allowed = key.most == 0           ? fmt::format("{} or more", key.least)
                                  : key.least == key.most ? fmt::format("{}", key.least)
                                                          : fmt::format("{} to {}", key.least, key.most);
      faults_.add(node.fault(at, fmt::format("{}has {} {}; allowed are {}", Node::subject(key.name), n,
                                             key.pairs ? "pairs" : "numbers", allowed)));
      return;
    }
    const Key element = one_of(key);
    const std::size_t before = faults_.size();
    for (std::size_t i = 0; i < n && faults_.size() == before; ++i) {  // the first wrong one is enough
      const Node one = node.element(i);
      if (key.pairs) {
        pair(one, element, Node::subject(key.name, i), fmt::format("{}/{}", at, i));
        continue;
      }
      const bool fits = one.is_number() && std::isfinite(one.number()) && key.range.holds(one.number());
      if (fits && !key.whole && !lost(key, one.number())) continue;
      number(one, element, Node::subject(key.name, i), fmt::format("{}/{}", at, i));
    }
  }

  void pair(const Node& node, const Key& element, const std::string& what, const std::string& at) {
    if (!node.is_list() || node.size() != 2) {
      faults_.add(node.fault(
          at, fmt::format("{}must be a pair of numbers, got {}", what,
                          node.is_list() ? fmt::format("{} elements", node.size()) : std::string(node.type_name()))));
      return;
    }
    for (std::size_t i = 0; i < 2; ++i) number(node.element(i), element, what, fmt::format("{}/{}", at, i));
  }

  static Key one_of(const Key& key) {
    Key element;
    element.name = key.name;
    element.unit = key.unit;
    element.range = key.range;
    element.whole = key.whole;
    return element;
  }

  void text(const Node& node, const Key& key, const std::string& at) {
    if (!node.is_text()) return wrong_type(node, key, at, "a string in quotes");
    const std::string& value = node.text();
    const std::size_t limit = key.long_text ? 2000 : 200;
    const auto say = [&](const std::string& message) {
      faults_.add(node.fault(at, Node::subject(key.name) + message));
    };
    if (key.type == KeyType::word) return word(node, key, at);
    if (value.empty() && !key.empty_text)
      say("must not be empty");
    else if (Node::is_toml && value.size() > limit)
      say(fmt::format("has {} bytes; at most {} are allowed", value.size(), limit));
    else if (Node::is_toml &&
             std::any_of(value.begin(), value.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }))
      say("holds a control character; printable text on one line is allowed");
  }

  void word(const Node& node, const Key& key, const std::string& at) {
    const std::string& value = node.text();
    if (std::find(key.words.begin(), key.words.end(), value) != key.words.end()) return;
    if (!key.noun.empty()) {
      faults_.add(node.fault(at, unknown_name(key.noun, value, key.words)));
      return;
    }
    const std::string near = nearest(value, std::vector<std::string_view>(key.words.begin(), key.words.end()));
    faults_.add(node.fault(
        at, fmt::format("{}\"{}\" is unknown; {}allowed are {}", Node::equals(Node::subject(key.name)), value,
                        near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near), fmt::join(key.words, ", "))));
  }

  void texts(const Node& node, const Key& key, const std::string& at) {
    Key one = key;
    one.type = key.type == KeyType::words ? KeyType::word : KeyType::text;
    one.empty_text = true;
    if (node.is_text()) return text(node, one, at);
    if (!node.is_list() || (node.size() == 0 && key.least > 0)) {
      faults_.add(node.fault(at, Node::subject(key.name) + "must be a string or a list of strings" +
                                     (key.least > 0 ? ", not empty" : "")));
      return;
    }
    for (std::size_t i = 0; i < node.size() && !faults_.full(); ++i) {
      const Node element = node.element(i);
      const std::string place = fmt::format("{}/{}", at, i);
      if (element.is_text())
        text(element, one, place);
      else
        faults_.add(element.fault(place, Node::subject(key.name) + "must be a list of strings"));
    }
  }

  void inner_table(const Node& node, const Key& key, const std::string& at) {
    if (!node.is_table()) return faults_.add(node.fault(at, Node::no_table(key.name, node)));
    if (!key.free) table(node, key.keys, fmt::format("[{}]", key.name), at);
  }

  void inner_tables(const Node& node, const Key& key, const std::string& at) {
    if (!node.is_list()) return faults_.add(node.fault(at, Node::no_list(key.name, node)));
    for (std::size_t i = 0; i < node.size() && !faults_.full(); ++i) {
      const Node element = node.element(i);
      const std::string place = fmt::format("{}/{}", at, i);
      if (element.is_table())
        table(element, key.keys, fmt::format("[[{}]] {}", key.name, i + 1), place);
      else
        faults_.add(element.fault(place, Node::no_element(key.name, i, element)));
    }
  }

  /// A suggestion for an unknown key.
  std::string hint(std::string_view name, const std::vector<Key>& keys) const {
    const auto known = names_of(keys);
    if (Node::is_toml && nearest(name, known).empty()) {
      if (const std::string home = home_of(name, top_); !home.empty())
        return fmt::format("`{}` belongs {}", name, home);
    }
    return suggest(name, known);
  }

  /// The place where a key is allowed: "in [[corner]] or [program]", "at the top, before any table"; may be empty.
  static std::string home_of(std::string_view name, const std::vector<Key>& top) {
    if (const Key* key = find_key(top, name); key && key->type != KeyType::table && key->type != KeyType::tables)
      return "at the top, before any table";
    std::vector<std::string> homes;
    for (const Key& key : top) {
      if (find_key(key.keys, name))
        homes.push_back(key.type == KeyType::table ? "[" + key.name + "]" : "[[" + key.name + "]]");
    }
    return homes.empty() ? "" : fmt::format("in {}", fmt::join(homes, " or "));
  }

  const std::vector<Key>& top_;
  Faults& faults_;
};

}  // namespace accdec
