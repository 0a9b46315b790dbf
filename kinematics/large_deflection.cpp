#include "kinematics/large_deflection.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace flextip {
namespace {

// With sin(phi) = s (1 - u^2), s = sin(phi_end), Belendez's
//   alpha = 1/4 [int_0^phi_end dphi / sqrt(s - sin(phi))]^2
// becomes alpha = s I^2 with the smooth I = int_0^1 du / w, w = sqrt(1 - s^2 (1 - u^2)^2). In the
// same way the reach is 1 / I, and the deflection (int_0^1 s (1 - u^2) / w du) / I.
struct Integrals {
  double I = 0.0, dI_ds = 0.0, deflection = 0.0;
};

constexpr int kNodes = 40;
struct Rule {
  std::array<double, kNodes> node{}, weight{};
};

// Makes Gauss and Legendre's rule on [0, 1], nodes by Newton's method.
Rule MakeRule() {
  Rule rule;
  for (int i = 0; i < kNodes; ++i) {
    double x = std::cos(M_PI * (i + 0.75) / (kNodes + 0.5)), slope = 1.0;
    for (int pass = 0; pass < 20; ++pass) {
      double p0 = 1.0, p1 = x;
      for (int k = 2; k <= kNodes; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = kNodes * (x * p1 - p0) / (x * x - 1.0);
      x -= p1 / slope;
    }
    rule.node[i] = 0.5 * (1.0 + x);
    rule.weight[i] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}
const Rule kRule = MakeRule();

// The nodes are spread as u = v^2, which keeps the rule exact where s nears 1 and w falls to a
// small value at u = 0.
Integrals Integrate(double s) {
  Integrals sum;
  for (int i = 0; i < kNodes; ++i) {
    const double v = kRule.node[i], u = v * v, du = 2.0 * v * kRule.weight[i];
    const double g = 1.0 - u * u, w2 = 1.0 - s * s * g * g, w = std::sqrt(w2);
    sum.I += du / w;
    sum.dI_ds += du * s * g * g / (w2 * w);
    sum.deflection += du * s * g / w;
  }
  return sum;
}

}  // namespace

Cantilever BendCantilever(double alpha) noexcept {
  assert(alpha >= 0);
  alpha = std::min(alpha, kMaxCantileverLoad);
  // alpha(s) grows and bends upward: after its first step Newton's method comes from above.
  double s = std::min(alpha, 0.9);
  Integrals at = Integrate(s);
  for (int i = 0; i < 30; ++i) {
    const double step = (s * at.I * at.I - alpha) / (at.I * (at.I + 2.0 * s * at.dI_ds));
    s = std::clamp(s - step, 0.5 * s, 0.5 * (s + 1.0));
    at = Integrate(s);
    if (std::abs(step) < 1e-15) break;
  }
  return {std::asin(s), 1.0 / at.I, at.deflection / at.I};
}

double BentChord(double F, double a, double length) noexcept {
  const double L = length, b = L - a, load = std::abs(F);
  const double alpha_wrist = 0.5 * load * b / L * a * a;  // (5.14), (5.16)
  const double alpha_tip = 0.5 * load * a / L * b * b;    // (5.15), (5.17)
  const Cantilever wrist = BendCantilever(alpha_wrist), tip = BendCantilever(alpha_tip);
  return std::hypot(a * wrist.reach + b * tip.reach, b * tip.deflection - a * wrist.deflection);
}

}  // namespace flextip
