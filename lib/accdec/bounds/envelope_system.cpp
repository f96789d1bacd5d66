#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/bounds/envelope_system.hpp>

namespace accdec {
namespace {

/// In four sums, so that they may be computed at once.
double product(const double* x, const double* y, std::size_t count) {
  double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    a += x[i] * y[i];
    b += x[i + 1] * y[i + 1];
    c += x[i + 2] * y[i + 2];
    d += x[i + 3] * y[i + 3];
  }
  for (; i < count; ++i) a += x[i] * y[i];
  return (a + b) + (c + d);
}

}  // namespace

EnvelopeSystem::EnvelopeSystem(std::vector<std::size_t> first) : first_(std::move(first)), pivots_(first_.size()) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < first_.size(); ++i) {
    begin_.push_back(size);
    size += i - first_[i] + 1;
  }
  entries_.resize(size);
}

double EnvelopeSystem::work() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < first_.size(); ++i) sum += 0.5 * std::pow(static_cast<double>(i - first_[i]), 2);
  return sum;
}

void EnvelopeSystem::factor() {
  for (std::size_t i = 0; i < first_.size(); ++i) {
    double* const row = &entries_[begin_[i]];
    const std::size_t from = first_[i];
    for (std::size_t j = from; j < i; ++j) {  // L D
      const std::size_t begin = std::max(from, first_[j]);
      row[j - from] -= product(row + (begin - from), &entries_[begin_[j] + begin - first_[j]], j - begin);
    }
    double pivot = row[i - from];
    for (std::size_t j = from; j < i; ++j) {
      const double scaled = row[j - from];
      row[j - from] = scaled / pivots_[j];
      pivot -= scaled * row[j - from];
    }
    pivots_[i] = pivot != 0.0 ? pivot : 1.0;
  }
}

void EnvelopeSystem::solve(std::vector<double>& x) {
  factor();
  const std::size_t n = first_.size();
  for (std::size_t i = 0; i < n; ++i) x[i] -= product(&entries_[begin_[i]], &x[first_[i]], i - first_[i]);
  for (std::size_t i = 0; i < n; ++i) x[i] /= pivots_[i];
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = first_[i]; j < i; ++j) x[j] -= entries_[begin_[i] + j - first_[i]] * x[i];
  }
}

}  // namespace accdec
