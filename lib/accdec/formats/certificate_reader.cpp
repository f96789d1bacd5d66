#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/files/json_position.hpp>
#include <accdec/files/packed_text.hpp>
#include <accdec/formats/certificate_json.hpp>
#include <accdec/formats/json_value.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

/// One node or row: an array of known length, read by index. Its place is written as text only for an error, because
/// certificates have hundreds of thousands of entries.
class Entry {
 public:
  Entry(const Json& json, const std::string& list, std::size_t index) : json_(json), list_(list), index_(index) {}

  [[noreturn]] void fail(const std::string& message) const {
    throw Mistake{fmt::format("{}/{}", list_, index_), message};
  }
  [[noreturn]] void fail(std::size_t i, const std::string& message) const {
    throw Mistake{fmt::format("{}/{}/{}", list_, index_, i), message};
  }
  std::size_t size() const { return json_.is_array() ? json_.size() : 0; }
  bool is_text(std::size_t i) const { return i < size() && json_[i].is_string(); }
  bool is_text(std::size_t i, std::string_view text) const {
    return is_text(i) && json_[i].get_ref<const std::string&>() == text;
  }
  int integer(std::size_t i) const {
    if (!json_[i].is_number_integer()) fail(i, fmt::format("must be a whole number, got {}", json_[i].type_name()));
    if (!fits(json_[i])) fail(i, "is out of range");
    return json_[i].get<int>();
  }
  /// The entry itself as a whole number.
  int integer() const {
    if (!fits(json_)) fail("is out of range");
    return json_.get<int>();
  }
  double number(std::size_t i) const {
    if (!json_[i].is_number()) fail(i, fmt::format("must be a number, got {}", json_[i].type_name()));
    return json_[i].get<double>();
  }
  bool boolean(std::size_t i) const {
    if (!json_[i].is_boolean()) fail(i, fmt::format("must be true or false, got {}", json_[i].type_name()));
    return json_[i].get<bool>();
  }
  /// Checks the length: a row has its name first, then the things it names, then the multiplier.
  void needs(std::size_t named) const {
    if (size() != named + 2) fail(fmt::format("has {} entries; such a row has {}", size(), named + 2));
  }
  const Json& json() const { return json_; }
  std::size_t index() const { return index_; }

 private:
  /// Numbers beyond 64 bits must not wrap around.
  static bool fits(const Json& json) {
    return std::abs(json.get<double>()) <= static_cast<double>(std::numeric_limits<int>::max());
  }
  const Json& json_;
  const std::string& list_;
  std::size_t index_;
};

proof::Tangent read_tangent(const Entry& e, std::size_t first) {
  return {e.integer(first), e.boolean(first + 1), e.boolean(first + 2)};
}

proof::Row read_row(const Entry& e) {
  const auto is = [&](std::string_view name, std::size_t named) {
    if (!e.is_text(0, name)) return false;
    e.needs(named);
    return true;
  };
  const auto event_power = [&](bool stop) {
    return proof::EventPower{stop, e.integer(1), e.integer(2), e.number(3), e.number(4)};
  };
  const auto blend_power = [&](bool regeneration) {
    return proof::BlendPower{regeneration, e.integer(1), e.integer(2), e.integer(3),
                             e.integer(4), e.number(5),  e.number(6)};
  };
  for (const AxisLimit& limit : axis_limits) {
    if (limit.differences >= 0 && is(to_string(limit.kind), 2))
      return proof::TapDifference{e.integer(1), e.integer(2), limit.kind};
    const bool in_blends = limit.differences >= 0 || limit.kind == LimitKind::force;
    if (in_blends && is(fmt::format("blend {}", to_string(limit.kind)), 4))
      return proof::Blend{limit.kind, e.integer(1), e.integer(2), e.integer(3), e.integer(4)};
  }
  if (is("blend force_speed", 6))
    return proof::Blend{LimitKind::force_speed, e.integer(1), e.integer(2), e.integer(3),
                        e.integer(4),           e.integer(5), e.integer(6)};
  if (is("force_speed start", 3)) return proof::EventForce{false, e.integer(1), e.integer(2), e.integer(3)};
  if (is("force_speed stop", 3)) return proof::EventForce{true, e.integer(1), e.integer(2), e.integer(3)};
  if (is("blend vibration", 5))
    return proof::Vibration{e.integer(1), e.number(3), e.number(5), e.number(4), e.integer(2)};
  if (is("force start", 2)) return proof::EventForce{false, e.integer(1), e.integer(2)};
  if (is("force stop", 2)) return proof::EventForce{true, e.integer(1), e.integer(2)};
  if (is("error", 2)) return proof::Error{e.integer(1), e.number(2)};
  if (is("range error", 8)) return proof::RangeError{e.integer(1), e.number(2), read_tangent(e, 3), read_tangent(e, 6)};
  if (is("contour", 2)) return proof::Contour{e.integer(1), e.boolean(2)};
  if (is("reversal", 4)) return proof::Reversal{e.integer(1), e.integer(2), e.integer(3), e.integer(4)};
  if (is("width", 2)) return proof::Width{e.integer(1), e.integer(2)};
  if (is("budget", 0)) return proof::Budget{};
  if (is("vibration", 3)) return proof::Vibration{e.integer(1), e.number(2), e.number(3)};
  if (is("damped vibration", 4)) return proof::Vibration{e.integer(1), e.number(2), e.number(4), e.number(3)};
  if (is("power start", 4)) return event_power(false);
  if (is("regeneration stop", 4)) return event_power(true);
  if (is("blend power", 6)) return blend_power(false);
  if (is("blend regeneration", 6)) return blend_power(true);
  if (is("speed", 4)) return proof::Speed{e.integer(1), e.integer(2), e.number(3), e.number(4)};
  if (is("response", 2)) return proof::Response{e.integer(1), e.integer(2)};
  e.fail("is a row of no known kind");
}

proof::Node read_node(const Entry& e) {
  const Json& json = e.json();
  if (json.is_null()) return proof::TooLong{};
  if (json.is_number_integer()) return proof::Refuted{e.integer()};
  if (json == "unreachable") return proof::Unreachable{};
  if (e.size() == 1 && e.is_text(0, "symmetric")) return proof::SymmetricOrders{};
  if (e.size() == 2 && e.is_text(0, "N")) return proof::OrderSplit{e.integer(1)};
  if (e.size() == 2 && e.is_text(0, "t")) return proof::InstantSplit{e.number(1)};
  if (e.size() == 5 && e.is_text(0, "instants"))
    return proof::RefutedInstants{e.number(1), e.number(2), e.integer(3), e.integer(4)};
  if (e.size() == 2 && e.is_text(0, "lemma")) return proof::ByLemma{e.integer(1)};
  if (e.size() == 2) return proof::RefutedSymmetric{e.integer(0), e.integer(1)};
  if (e.size() == 3 && e.is_text(1, "B")) return proof::ResponseSplit{e.integer(0), e.number(2)};
  if (e.size() == 3 && e.is_text(1, "c")) return proof::ContourSplit{e.integer(0), e.number(2)};
  if (e.size() == 4 && e.is_text(1, "r")) return proof::ReversalSplit{e.integer(0), e.integer(2), e.integer(3)};
  if (e.size() == 3 && e.is_text(1)) {
    if (!e.is_text(1, "d") && !e.is_text(1, "k")) e.fail(1, "the tree splits neither a delay nor a sample nor a time");
    return proof::Split{e.integer(0), e.is_text(1, "d"), e.integer(2)};
  }
  e.fail("is a node of no known kind");
}

/// Applies `read` to every entry of an array.
template <class Read>
auto read_list(const Json& json, const std::string& pointer, const Read& read) {
  if (!json.is_array()) throw Mistake{pointer, fmt::format("must be an array, got {}", json.type_name())};
  std::vector<decltype(read(Entry(json, pointer, 0)))> list;
  list.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) list.push_back(read(Entry(json[i], pointer, i)));
  return list;
}

proof::Lemma read_lemma(const Value& value) {
  value.members({"delays", "tree"}, {"from", "order", "window"});
  if (value.has("order") == value.has("window")) value.fail("has either an `order` or a `window`");
  constexpr long most = 100'000'000;
  const auto integers = [](const Value& list, std::size_t count) {
    std::vector<int> numbers;
    for (const Value& v : list.elements()) numbers.push_back(static_cast<int>(v.integer(-1, most)));
    if (numbers.size() != count) list.fail(fmt::format("has {} entries; such a list has {}", numbers.size(), count));
    return numbers;
  };
  proof::Lemma lemma;
  if (value.has("order")) {
    lemma.order = static_cast<int>(value["order"].integer(-1, most));
  } else {
    const std::vector<int> window = integers(value["window"], 3);
    lemma.window = proof::Window{window[0], window[1], window[2]};
  }
  const auto delays = [&](const char* member, std::vector<proof::CornerDelay>& into) {
    for (const Value& entry : value[member].elements()) {
      const std::vector<int> delay = integers(entry, 2);
      into.push_back({delay[0], delay[1]});
    }
  };
  delays("delays", lemma.delays);
  if (value.has("from")) delays("from", lemma.from);
  lemma.tree = read_list(value["tree"].json(), value["tree"].pointer(), read_node);
  return lemma;
}

proof::BranchAndBound read_branch_and_bound(const Value& value) {
  value.members({"schema", "kind", "objective", "bound_samples", "multipliers", "tree"},
                {"runs", "conflict", "corner_of", "in_position", "lemmas", "smoothed", "tolerance"});
  proof::BranchAndBound proof;
  proof.objective = value["objective"].word({Objective::cycle, Objective::corner});
  if (proof.objective == Objective::cycle) {
    if (!value.has("runs")) value.fail("lacks the member `runs`");
    proof.runs = value["runs"].number();
  }
  // A certificate without a tolerance is checked with the usual one.
  if (value.has("tolerance")) proof.tolerance = value["tolerance"].number();
  proof.bound_samples = value["bound_samples"].optional_number();
  if (value.has("conflict")) {
    for (const Value& limit : value["conflict"].elements()) proof.conflict.push_back(limit.text());
  }
  if (value.has("corner_of")) {
    for (const Value& kind : value["corner_of"].elements())
      proof.corner_of.push_back(static_cast<int>(kind.integer(0, 100'000'000)));
  }
  if (value.has("in_position")) proof.in_position = value["in_position"].boolean();
  if (value.has("smoothed")) proof.smoothed = value["smoothed"].boolean();
  const std::string sets = value["multipliers"].pointer();
  proof.multipliers = read_list(value["multipliers"].json(), sets, [&](const Entry& set) {
    const std::string rows = fmt::format("{}/{}", sets, set.index());
    return read_list(set.json(), rows, [](const Entry& row) {
      proof::Term term{read_row(row), 0.0};
      term.multiplier = row.number(row.size() - 1);
      return term;
    });
  });
  if (value.has("lemmas")) {
    for (const Value& lemma : value["lemmas"].elements()) proof.lemmas.push_back(read_lemma(lemma));
  }
  proof.tree = read_list(value["tree"].json(), value["tree"].pointer(), read_node);
  return proof;
}

/// A certificate without a design has no bound. No other member is ever null.
void refuse_nulls(const Value& value) {
  for (const auto& [key, member] : value.json().items()) {
    if (member.is_null() && key != "bound_samples") value[key].fail("must not be null; leave the member out");
  }
}

void require_schema(const Value& value) {
  if (value["schema"].text() != "accdec.certificate/1")
    value["schema"].fail("the certificate's schema is unknown; known is accdec.certificate/1");
}

/// A proof within another one.
proof::BranchAndBound read_inner(const Value& value) {
  refuse_nulls(value);
  proof::BranchAndBound proof = read_branch_and_bound(value);
  require_schema(value);
  if (value["kind"].text() != "branch and bound") value["kind"].fail("must be \"branch and bound\"");
  return proof;
}

proof::FamilyEnumeration read_families(const Value& value) {
  value.members({"schema", "kind", "bound_samples", "refuted"}, {"taps"});
  proof::FamilyEnumeration proof;
  proof.bound_samples = value["bound_samples"].optional_number();
  for (const Value& entry : value["refuted"].elements()) {
    const std::vector<Value> parts = entry.elements();
    if (parts.size() != 3) entry.fail(fmt::format("has {} entries: family, rule and members are 3", parts.size()));
    proof.refuted.push_back(
        {parts[0].text(), parts[1].text(), static_cast<int>(parts[2].integer(0, std::numeric_limits<int>::max()))});
  }
  if (value.has("taps")) proof.taps = read_inner(value["taps"]);
  return proof;
}

proof::CornerFeeds read_corner_feeds(const Value& value) {
  value.members({"schema", "kind", "bound_samples", "parts"});
  proof::CornerFeeds proof;
  proof.bound_samples = value["bound_samples"].optional_number();
  for (const Value& entry : value["parts"].elements()) {
    entry.members({"multiples", "orders"});
    proof::CornerFeedPart part;
    for (const Value& multiple : entry["multiples"].elements())
      part.multiples.push_back(static_cast<int>(multiple.integer(0, 100'000)));
    part.orders = read_inner(entry["orders"]);
    proof.parts.push_back(std::move(part));
  }
  return proof;
}

}  // namespace

namespace {

/// A packed certificate, with errors at the place of its packed text.
Certificate read_packed(const Value& value) {
  value.members({"kind", "schema", "gzip"});
  const Value packed = value["gzip"];
  const std::string letters = packed.text();
  try {
    const std::string text = unpack_text(letters, most_unpacked(letters.size()));
    if (text.find('\0') != std::string::npos) packed.fail("unpacks to what is no text: there is a zero byte in it");
    const Json json = Json::parse(text);
    if (json_too_deep(text)) packed.fail("unpacked: brackets nest more than 64 deep");
    if (duplicate_key(text)) packed.fail("unpacked: a key stands twice in its object");
    if (json.is_object() && json.contains("gzip")) packed.fail("is packed more than once");
    return read_certificate(Value(json, ""));
  } catch (const Mistake& error) {
    if (error.pointer == packed.pointer()) throw;
    packed.fail(fmt::format("unpacked, {}: {}", error.pointer.empty() ? "/" : error.pointer, error.message));
  } catch (const Json::exception& error) {
    packed.fail(fmt::format("unpacks to what is not valid JSON: {}", error.what()));
  } catch (const std::runtime_error& error) {
    packed.fail(error.what());
  }
}

}  // namespace

Certificate read_certificate(const Value& value) {
  value.members({"kind"},
                {"gzip", "schema", "objective", "runs", "bound_samples", "conflict", "corner_of", "in_position",
                 "lemmas", "multipliers", "smoothed", "tolerance", "tree", "refuted", "taps", "parts"});
  refuse_nulls(value);
  const std::string kind = value["kind"].text();
  if (kind == "enumeration") {
    value.members({"kind"}, {"schema"});
    if (value.has("schema")) require_schema(value);
    return {proof::Enumeration{}};
  }
  value.members({"kind", "schema"},
                {"gzip", "objective", "runs", "bound_samples", "conflict", "corner_of", "in_position", "lemmas",
                 "multipliers", "smoothed", "tolerance", "tree", "refuted", "taps", "parts"});
  require_schema(value);
  if (kind == "packed") return read_packed(value);
  if (kind == "constant feed") {
    value.members({"kind", "schema"});
    return {proof::ConstantFeed{}};
  }
  if (kind == "corner speed") {
    value.members({"kind", "schema"});
    return {proof::CornerSpeed{}};
  }
  if (kind == "branch and bound") return {read_branch_and_bound(value)};
  if (kind == "families") return {read_families(value)};
  if (kind == "corner feeds") return {read_corner_feeds(value)};
  value["kind"].fail(
      fmt::format("\"{}\" is unknown; allowed are constant feed, corner speed, enumeration, branch and bound, "
                  "families, corner feeds, packed",
                  kind));
}

}  // namespace accdec
