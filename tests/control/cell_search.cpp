#include "cell_search.h"

#include <array>
#include <cmath>
#include <deque>
#include <numbers>

namespace flextip {
namespace {

using Real = long double;
using Form = Eigen::Matrix<Real, 3, 3>;
using Quadratic = std::array<std::array<Real, 3>, 3>;  // Bernstein coefficients, degree 2 by 2
using Quartic = std::array<std::array<Real, 5>, 5>;

/// w = (1, x, y), its coordinates turned by `face`. In the plane y is zero throughout.
struct Cell {
  int face;
  Real x0, x1, y0, y1;
};

/// Bernstein coefficients of w^T B w on a cell.
Quadratic Coefficients(const Form& B, const Cell& cell) {
  const std::array<Real, 3> x1{cell.x0, (cell.x0 + cell.x1) / 2, cell.x1};
  const std::array<Real, 3> x2{cell.x0 * cell.x0, cell.x0 * cell.x1, cell.x1 * cell.x1};
  const std::array<Real, 3> y1{cell.y0, (cell.y0 + cell.y1) / 2, cell.y1};
  const std::array<Real, 3> y2{cell.y0 * cell.y0, cell.y0 * cell.y1, cell.y1 * cell.y1};
  Quadratic q{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      q[i][j] = B(0, 0) + 2 * B(0, 1) * x1[i] + 2 * B(0, 2) * y1[j] + B(1, 1) * x2[i] +
                B(2, 2) * y2[j] + 2 * B(1, 2) * x1[i] * y1[j];
    }
  }
  return q;
}

/// sum + factor p q, in Bernstein form.
void AddProduct(Real factor, const Quadratic& p, const Quadratic& q, Quartic& sum) {
  // binomial(2, i) binomial(2, k) / binomial(4, i + k)
  static constexpr std::array<std::array<Real, 3>, 3> kWeight{
      {{1.0L, 0.5L, 1.0L / 6}, {0.5L, 2.0L / 3, 0.5L}, {1.0L / 6, 0.5L, 1.0L}}};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        for (int l = 0; l < 3; ++l) {
          sum[i + k][j + l] += factor * kWeight[i][k] * kWeight[j][l] * p[i][j] * q[k][l];
        }
      }
    }
  }
}

template <class Coefficients>
bool AllPositive(const Coefficients& coefficients) {
  for (const auto& row : coefficients) {
    for (const Real value : row) {
      if (!(value > 0)) return false;
    }
  }
  return true;
}

/// The forms of one face: dot product, squared norms and cross product of H w and T w.
struct FaceForms {
  Form dot, desired, actual;
  std::array<Form, 3> across;
};

Form Symmetric(const Form& B) { return (B + B.transpose()) / 2; }

FaceForms MakeForms(const Form& h, const Form& t) {
  FaceForms forms{Symmetric(h.transpose() * t), h.transpose() * h, t.transpose() * t, {}};
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    forms.across[k] = Symmetric(h.row(i).transpose() * t.row(j) - h.row(j).transpose() * t.row(i));
  }
  return forms;
}

/// One search.
template <int N>
class Search {
 public:
  Search(const MotionPair<N>& pair, double start, double tolerance)
      : pair_(pair), tolerance_(tolerance) {
    result_.angle = start;
    for (int face = 0; face < N; ++face) {
      Form h = Form::Zero(), t = Form::Zero();
      for (int k = 0; k < N; ++k) {  // columns in the order of this face's (1, x, y)
        const int from = (face + k) % N;
        h.col(k).template head<N>() = pair.H.col(from).template cast<Real>();
        t.col(k).template head<N>() = pair.T.col(from).template cast<Real>();
      }
      forms_[face] = MakeForms(h, t);
      open_.push_back({face, -1, 1, N == 3 ? -1.0L : 0.0L, N == 3 ? 1.0L : 0.0L});
    }
    SetLimit();
  }

  CellSearchResult Run() {
    constexpr long kMaxCells = 1'000'000;
    while (!open_.empty() && result_.angle < std::numbers::pi - tolerance_) {
      if (++result_.cells > kMaxCells) return result_;
      const Cell cell = open_.front();
      open_.pop_front();
      if (!CanDrop(cell)) Cut(cell);
    }
    result_.decided = true;
    return result_;
  }

 private:
  void SetLimit() { limit_ = static_cast<Real>(result_.angle) + tolerance_; }

  /// Past 90 degrees: the cosine is positive or the sine larger than the limit's, on all of the
  /// cell. Up to 90 degrees: the cosine is positive and the sine smaller.
  bool CanDrop(const Cell& cell) {
    const FaceForms& forms = forms_[cell.face];
    const Quadratic s = Coefficients(forms.dot, cell), n = Coefficients(forms.desired, cell),
                    m = Coefficients(forms.actual, cell);
    std::array<Quadratic, 3> across;
    for (int k = 0; k < 3; ++k) across[k] = Coefficients(forms.across[k], cell);
    LookAtCorners(cell, s, across);
    const bool past = limit_ > std::numbers::pi_v<Real> / 2;
    const bool ahead = AllPositive(s);
    if (ahead == past) return past;
    const Real sign = past ? 1 : -1, sine = std::sin(limit_);
    Quartic larger{};
    for (const Quadratic& component : across) AddProduct(sign, component, component, larger);
    AddProduct(-sign * sine * sine, n, m, larger);
    return AllPositive(larger);
  }

  /// Corners are the polynomials' own values.
  void LookAtCorners(const Cell& cell, const Quadratic& s, const std::array<Quadratic, 3>& across) {
    for (const int i : {0, 2}) {
      for (const int j : {0, 2}) {
        const Real size = std::hypot(across[0][i][j], across[1][i][j], across[2][i][j]);
        const Real angle = std::atan2(size, s[i][j]);
        if (angle > limit_)
          Raise(cell, i == 0 ? cell.x0 : cell.x1, j == 0 ? cell.y0 : cell.y1, angle);
      }
    }
  }

  void Raise(const Cell& cell, Real x, Real y, Real angle) {
    const double size = static_cast<double>(std::max(cell.x1 - cell.x0, cell.y1 - cell.y0));
    const SphereMaximum<N> top =
        Refine(pair_, cell.face, static_cast<double>(x), static_cast<double>(y), 0.25 * size);
    result_.raised = true;
    result_.angle = std::max(static_cast<double>(angle), top.angle);
    SetLimit();
  }

  void Cut(const Cell& cell) {
    const Real x = (cell.x0 + cell.x1) / 2, y = (cell.y0 + cell.y1) / 2;
    if (cell.x1 - cell.x0 >= cell.y1 - cell.y0) {
      open_.push_back({cell.face, cell.x0, x, cell.y0, cell.y1});
      open_.push_back({cell.face, x, cell.x1, cell.y0, cell.y1});
    } else {
      open_.push_back({cell.face, cell.x0, cell.x1, cell.y0, y});
      open_.push_back({cell.face, cell.x0, cell.x1, y, cell.y1});
    }
  }

  const MotionPair<N>& pair_;
  double tolerance_;
  Real limit_ = 0;
  std::array<FaceForms, N> forms_;
  std::deque<Cell> open_;
  CellSearchResult result_;
};

}  // namespace

template <int N>
CellSearchResult SearchCells(const MotionPair<N>& pair, double start_angle, double tolerance) {
  return Search<N>(pair, start_angle, tolerance).Run();
}

template CellSearchResult SearchCells<2>(const MotionPair<2>&, double, double);
template CellSearchResult SearchCells<3>(const MotionPair<3>&, double, double);

}  // namespace flextip
