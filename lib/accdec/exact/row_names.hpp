#pragma once

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include <accdec/certificate.hpp>

// Internal to the exact method.

namespace accdec::exact {

/// Symmetry of filters of one order, or the sum of taps (order 0). It is no limit, so it is no part of a proof.
struct Equation {
  int order = 0;
};
/// Meaning of a row of the linear program.
using RowName = std::variant<Equation, proof::Row>;

/// The limit of a row if it is of this kind; else null.
template <class Limit>
const Limit* limit_of(const RowName& name) {
  const auto* row = std::get_if<proof::Row>(&name);
  return row != nullptr ? std::get_if<Limit>(row) : nullptr;
}

/// The meaning of every row of the linear program, in their order: base rows first, then cuts.
class RowNames {
 public:
  int rows() const { return static_cast<int>(names_.size()); }
  int base() const { return base_; }
  RowName& operator[](int row) { return names_[static_cast<std::size_t>(row)]; }
  const RowName& operator[](int row) const { return names_[static_cast<std::size_t>(row)]; }

  void add(RowName name) { names_.push_back(std::move(name)); }
  /// The rows so far are base rows.
  void end_base() { base_ = rows(); }
  /// The last row takes the place of the one removed.
  void remove(int row) {
    (*this)[row] = names_.back();
    names_.pop_back();
  }
  void remove_cuts() { names_.resize(static_cast<std::size_t>(base_)); }

  /// Whether the cuts have a row of this kind that is the same according to `same`.
  template <class Limit, class Same>
  bool known(const Same& same) const {
    return std::any_of(names_.begin() + base_, names_.end(), [&](const RowName& name) {
      const Limit* old = limit_of<Limit>(name);
      return old != nullptr && same(*old);
    });
  }
  /// Whether this limit is a cut.
  bool known(const proof::Row& limit) const {
    return std::any_of(names_.begin() + base_, names_.end(), [&](const RowName& name) {
      const auto* row = std::get_if<proof::Row>(&name);
      return row != nullptr && *row == limit;
    });
  }

 private:
  std::vector<RowName> names_;
  int base_ = 0;
};

}  // namespace accdec::exact
