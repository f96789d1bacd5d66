#pragma once

#include <cmath>

#include <Eigen/Core>

namespace accdec::testing {

/// A number with its gradient and Hessian: forward differentiation, exact to rounding. Lets a case be written once, as
/// its formula.
struct Second {
  double v = 0.0;
  Eigen::VectorXd g;
  Eigen::MatrixXd h;

  /// Variable i of n.
  static Second variable(double value, int i, int n) {
    Second s{value, Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
    s.g[i] = 1.0;
    return s;
  }
  /// f(a) from f, f' and f''.
  static Second chain(const Second& a, double f, double df, double ddf) {
    return {f, df * a.g, df * a.h + ddf * a.g * a.g.transpose()};
  }
};

inline Second operator+(const Second& a, const Second& b) {
  return {a.v + b.v, a.g + b.g, a.h + b.h};
}
inline Second operator-(const Second& a, const Second& b) {
  return {a.v - b.v, a.g - b.g, a.h - b.h};
}
inline Second operator*(const Second& a, const Second& b) {
  return {a.v * b.v, a.v * b.g + b.v * a.g, a.v * b.h + b.v * a.h + a.g * b.g.transpose() + b.g * a.g.transpose()};
}
inline Second operator+(const Second& a, double b) {
  return {a.v + b, a.g, a.h};
}
inline Second operator-(const Second& a, double b) {
  return a + -b;
}
inline Second operator*(double b, const Second& a) {
  return {b * a.v, b * a.g, b * a.h};
}
inline Second operator-(double b, const Second& a) {
  return -1.0 * a + b;
}
inline Second sin(const Second& a) {
  return Second::chain(a, std::sin(a.v), std::cos(a.v), -std::sin(a.v));
}
inline Second log(const Second& a) {
  return Second::chain(a, std::log(a.v), 1.0 / a.v, -1.0 / (a.v * a.v));
}
inline Second sqr(const Second& a) {
  return a * a;
}
inline Second cube(const Second& a) {
  return a * a * a;
}

}  // namespace accdec::testing
