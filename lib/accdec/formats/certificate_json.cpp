#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/packed_text.hpp>
#include <accdec/formats/certificate_json.hpp>
#include <accdec/formats/json_number.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

constexpr std::size_t packed_above = 1'000'000;  // bytes

// The entries of a row before its multiplier.

using Name = std::string_view;

auto parts(const proof::TapDifference& r) {
  return std::tuple(Name(to_string(r.limit)), r.sample, r.sign);
}
auto parts(const proof::EventForce& r) {
  return std::tuple(Name(r.stop ? "force stop" : "force start"), r.axis, r.sample);
}
/// The same below a line of the force-speed curve.
auto curve_parts(const proof::EventForce& r) {
  return std::tuple(Name(r.stop ? "force_speed stop" : "force_speed start"), r.axis, r.sample, r.line);
}
auto parts(const proof::Blend& r) {
  return std::tuple(fmt::format("blend {}", to_string(r.limit)), r.corner, r.axis, r.sample, r.sign);
}
auto parts(const proof::Error& r) {
  return std::tuple(Name("error"), r.corner, r.angle);
}
auto parts(const proof::RangeError& r) {
  return std::tuple(Name("range error"), r.corner, r.angle, r.in.at, r.in.after, r.in.high, r.out.at, r.out.after,
                    r.out.high);
}
auto parts(const proof::Contour& r) {
  return std::tuple(Name("contour"), r.corner, r.out);
}
auto parts(const proof::Reversal& r) {
  return std::tuple(Name("reversal"), r.corner, r.axis, r.sample, r.sign);
}
auto parts(const proof::Width& r) {
  return std::tuple(Name("width"), r.within, r.before);
}
auto parts(const proof::Budget&) {
  return std::tuple(Name("budget"));
}
auto parts(const proof::Vibration& r) {
  return std::tuple(Name("vibration"), r.mode, r.frequency, r.angle);
}
/// The same at the blend of one corner, of a mode of an axis.
auto blend_parts(const proof::Vibration& r) {
  return std::tuple(Name("blend vibration"), r.mode, r.corner, r.frequency, r.damping, r.angle);
}
/// The same with damping.
auto damped_parts(const proof::Vibration& r) {
  return std::tuple(Name("damped vibration"), r.mode, r.frequency, r.damping, r.angle);
}
auto parts(const proof::EventPower& r) {
  return std::tuple(Name(r.stop ? "regeneration stop" : "power start"), r.axis, r.sample, r.low, r.high);
}
auto parts(const proof::BlendPower& r) {
  return std::tuple(Name(r.regeneration ? "blend regeneration" : "blend power"), r.corner, r.axis, r.sample, r.sign,
                    r.low, r.high);
}
auto parts(const proof::Speed& r) {
  return std::tuple(Name("speed"), r.corner, r.sample, r.low, r.high);
}
auto parts(const proof::Response& r) {
  return std::tuple(Name("response"), r.sample, r.sign);
}

// Nodes: null, a name, a number or a list.

auto parts(const proof::TooLong&) {
  return nullptr;
}
auto parts(const proof::Unreachable&) {
  return Name("unreachable");
}
auto parts(const proof::Refuted& n) {
  return n.multipliers;
}
auto parts(const proof::RefutedSymmetric& n) {
  return std::tuple(n.multipliers, n.shorter);
}
auto parts(const proof::SymmetricOrders&) {
  return std::tuple(Name("symmetric"));
}
auto parts(const proof::Split& n) {
  return std::tuple(n.corner, Name(n.on_delay ? "d" : "k"), n.at);
}
auto parts(const proof::ContourSplit& n) {
  return std::tuple(n.corner, Name("c"), n.at);
}
auto parts(const proof::ReversalSplit& n) {
  return std::tuple(n.corner, Name("r"), n.axis, n.at);
}
auto parts(const proof::InstantSplit& n) {
  return std::tuple(Name("t"), n.at);
}
auto parts(const proof::RefutedInstants& n) {
  return std::tuple(Name("instants"), n.in, n.out, n.first, n.last);
}
auto parts(const proof::OrderSplit& n) {
  return std::tuple(Name("N"), n.at);
}
auto parts(const proof::ResponseSplit& n) {
  return std::tuple(n.sample, Name("B"), n.level);
}
auto parts(const proof::ByLemma& n) {
  return std::tuple(Name("lemma"), n.lemma);
}

/// Writes a certificate directly as text: writing it as a tree of values takes longer than many proofs.
class Writer {
 public:
  std::string text;

  template <class Value>
  void member(Name name, const Value& value) {
    text += text.empty() || text.back() == '{' ? "" : ",";
    put(name);
    text += ':';
    put(value);
  }
  void put(const proof::ConstantFeed&) { kind_alone("constant feed"); }
  void put(const proof::CornerSpeed&) { kind_alone("corner speed"); }
  void put(const proof::Enumeration&) { text += R"({"kind":"enumeration"})"; }
  void put(const proof::BranchAndBound& proof) {
    text += '{';
    bound(proof.bound_samples);
    if (!proof.conflict.empty()) member("conflict", proof.conflict);
    if (proof.in_position) member("in_position", true);
    member("kind", Name("branch and bound"));
    if (!proof.corner_of.empty()) member("corner_of", proof.corner_of);
    if (!proof.lemmas.empty()) member("lemmas", proof.lemmas);
    member("multipliers", proof.multipliers);
    member("objective", to_string(proof.objective));
    if (proof.objective == Objective::cycle) member("runs", proof.runs);
    member("schema", Name("accdec.certificate/1"));
    if (proof.smoothed) member("smoothed", true);
    member("tolerance", proof.tolerance);
    member("tree", proof.tree);
    text += '}';
  }
  void put(const proof::CornerFeeds& proof) {
    text += '{';
    bound(proof.bound_samples);
    member("kind", Name("corner feeds"));
    member("parts", proof.parts);
    member("schema", Name("accdec.certificate/1"));
    text += '}';
  }
  void put(const proof::FamilyEnumeration& proof) {
    text += '{';
    bound(proof.bound_samples);
    member("kind", Name("families"));
    member("refuted", proof.refuted);
    member("schema", Name("accdec.certificate/1"));
    if (proof.taps) member("taps", *proof.taps);
    text += '}';
  }

 private:
  void put(const proof::CornerFeedPart& part) {
    text += '{';
    member("multiples", part.multiples);
    member("orders", part.orders);
    text += '}';
  }
  void put(const proof::RefutedMembers& r) { put(std::tuple(r.family, r.rule, r.members)); }
  void kind_alone(Name kind) {
    text += '{';
    member("schema", Name("accdec.certificate/1"));
    member("kind", kind);
    text += '}';
  }

  void bound(const std::optional<double>& samples) {
    samples ? member("bound_samples", *samples) : member("bound_samples", nullptr);
  }

  void put(std::nullptr_t) { text += "null"; }
  void put(bool value) { text += value ? "true" : "false"; }
  void put(int value) { fmt::format_to(std::back_inserter(text), "{}", value); }
  void put(double value) { append_number(text, value); }
  /// A name of letters and blanks, which needs no escapes.
  void put(Name name) {
    text += '"';
    text += name;
    text += '"';
  }
  void put(const std::string& words) {
    text += nlohmann::json(words).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  template <class Element>
  void put(const std::vector<Element>& list) {
    text += '[';
    for (const Element& element : list) {
      if (&element != list.data()) text += ',';
      put(element);
    }
    text += ']';
  }
  template <class... Parts>
  void put(const std::tuple<Parts...>& list) {
    Name before = "[";
    std::apply([&](const auto&... part) { ((text += std::exchange(before, ","), put(part)), ...); }, list);
    text += ']';
  }

  void put(const proof::Term& term) {
    const std::tuple last(term.multiplier);
    if (const auto* vibration = std::get_if<proof::Vibration>(&term.row)) {
      if (vibration->corner >= 0) return put(std::tuple_cat(blend_parts(*vibration), last));
      if (vibration->damping > 0.0) return put(std::tuple_cat(damped_parts(*vibration), last));
    }
    if (const auto* force = std::get_if<proof::EventForce>(&term.row); force && force->line >= 0)
      return put(std::tuple_cat(curve_parts(*force), last));
    if (const auto* blend = std::get_if<proof::Blend>(&term.row); blend && blend->limit == LimitKind::force_speed)
      return put(std::tuple_cat(parts(*blend), std::tuple(blend->line, blend->direction), last));
    std::visit([&](const auto& row) { put(std::tuple_cat(parts(row), last)); }, term.row);
  }
  void put(const proof::Node& node) {
    std::visit([&](const auto& n) { put(parts(n)); }, node);
  }

  void put(const proof::CornerDelay& d) { put(std::tuple(d.corner, d.delay)); }
  void put(const proof::Lemma& lemma) {
    text += '{';
    member("delays", lemma.delays);
    if (!lemma.from.empty()) member("from", lemma.from);
    if (lemma.window)
      member("window", std::tuple(lemma.window->order, lemma.window->anchor, lemma.window->at));
    else
      member("order", lemma.order);
    member("tree", lemma.tree);
    text += '}';
  }
};

}  // namespace

std::string certificate_to_json(const Certificate& certificate) {
  Writer writer;
  std::visit([&](const auto& proof) { writer.put(proof); }, certificate.proof);
  return std::move(writer.text);
}

std::string stored_certificate(const Certificate& certificate) {
  std::string plain = certificate_to_json(certificate);
  if (plain.size() <= packed_above) return plain;
  const std::string packed = pack_text(plain);
  if (plain.size() > most_unpacked(packed.size())) return plain;
  return fmt::format(R"({{"gzip":"{}","kind":"packed","schema":"accdec.certificate/1"}})", packed);
}

}  // namespace accdec
