#include "game.hpp"

#include <algorithm>
#include <cmath>

namespace accdec::attack {

Game::Game(std::size_t taps, double most)
    : n_(taps), shift_(most + 1.0), reduced_(taps + 1, 1.0), nonbasic_(taps), best_(taps) {
  reduced_[n_] = 0.0;
  for (std::size_t j = 0; j < n_; ++j) nonbasic_[j] = j;
  const std::vector<double> zero(n_, 0.0);
  add(zero.data());
}

void Game::add(const double* row) {
  const std::size_t slack = n_ + rows_.size() / n_;
  rows_.insert(rows_.end(), row, row + n_);
  // slack = 1 - (a + shift) x, written in what is not basic now.
  std::vector<double> fresh(n_ + 1, 0.0);
  fresh[n_] = 1.0;
  for (std::size_t j = 0; j < n_; ++j) {
    if (nonbasic_[j] < n_) fresh[j] += row[nonbasic_[j]] + shift_;
  }
  for (std::size_t i = 0; i < basic_.size(); ++i) {
    if (basic_[i] >= n_) continue;
    const double weight = row[basic_[i]] + shift_;
    const double* t = &table_[i * (n_ + 1)];
    for (std::size_t j = 0; j <= n_; ++j) fresh[j] -= weight * t[j];
  }
  table_.insert(table_.end(), fresh.begin(), fresh.end());
  basic_.push_back(slack);
}

void Game::pivot(std::size_t row, std::size_t column) {
  const std::size_t width = n_ + 1;
  double* p = &table_[row * width];
  const double by = 1.0 / p[column];
  for (std::size_t j = 0; j < width; ++j) p[j] *= by;
  p[column] = by;
  const auto eliminate = [&](double* t, double sign) {
    const double factor = t[column];
    if (factor == 0.0) return;
    t[column] = 0.0;
    for (std::size_t j = 0; j < n_; ++j) t[j] -= factor * p[j];
    t[n_] -= sign * factor * p[n_];
  };
  for (std::size_t i = 0; i < basic_.size(); ++i) {
    if (i != row) eliminate(&table_[i * width], 1.0);
  }
  eliminate(reduced_.data(), -1.0);
  std::swap(basic_[row], nonbasic_[column]);
}

bool Game::solve() {
  const std::size_t width = n_ + 1;
  for (int step = 0; step < 2000; ++step) {
    std::size_t row = basic_.size(), column = n_;
    double most = -1e-12;
    for (std::size_t i = 0; i < basic_.size(); ++i) {
      if (table_[i * width + n_] < most) most = table_[i * width + n_], row = i;
    }
    if (row < basic_.size()) {  // dual step: no objective of the others becomes positive
      const double* t = &table_[row * width];
      double least = INFINITY;
      for (std::size_t j = 0; j < n_; ++j) {
        if (t[j] >= -1e-12) continue;
        const double ratio = std::min(reduced_[j], 0.0) / t[j];
        if (ratio < least) least = ratio, column = j;
      }
      if (column == n_) return false;
      pivot(row, column);
      continue;
    }
    double gain = 1e-12;
    for (std::size_t j = 0; j < n_; ++j) {
      if (reduced_[j] > gain) gain = reduced_[j], column = j;
    }
    if (column == n_) {
      read();
      return true;
    }
    double least = INFINITY;  // primal step: at the beginning only
    for (std::size_t i = 0; i < basic_.size(); ++i) {
      const double* t = &table_[i * width];
      if (t[column] > 1e-12 && t[n_] / t[column] < least) least = t[n_] / t[column], row = i;
    }
    if (row == basic_.size()) return false;
    pivot(row, column);
  }
  return false;
}

void Game::read() {
  std::fill(best_.begin(), best_.end(), 0.0);
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < basic_.size(); ++i) {
    if (basic_[i] < n_) sum += best_[basic_[i]] = std::max(0.0, table_[i * (n_ + 1) + n_]);
  }
  for (double& b : best_) b /= sum;
  std::vector<double> mixed(n_, 0.0);
  for (std::size_t j = 0; j < n_; ++j) {
    const double weight = std::max(0.0, -reduced_[j]);
    if (nonbasic_[j] < n_ || weight == 0.0) continue;
    weights += weight;
    const double* row = &rows_[(nonbasic_[j] - n_) * n_];
    for (std::size_t i = 0; i < n_; ++i) mixed[i] += weight * row[i];
  }
  lower_ = *std::min_element(mixed.begin(), mixed.end()) / weights;
}

}  // namespace accdec::attack
