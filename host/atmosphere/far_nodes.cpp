#include "atmosphere/far_nodes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {

using Eigen::ArrayXd, Eigen::MatrixXd, Eigen::VectorXd;

/// Values of s2 for fit and check: 0, and evenly spaced in its logarithm from well below the smallest lift to 1.
ArrayXd spread_of_sine2(double smallest_lift, Eigen::Index count) {
  ArrayXd s2(count);
  s2[0] = 0;
  s2.tail(count - 1) = ArrayXd::LinSpaced(count - 1, std::log(1e-3 * smallest_lift), 0.0).exp();
  return s2;
}

class FarFitter {
 public:
  FarFitter(const FarMedium &medium, bool bending_only)
      : quantities_(bending_only ? 1 : layer_quantities),
        lift_(Eigen::Map<const ArrayXd>(medium.lift.data(), Eigen::Index(medium.lift.size()))),
        weight_(lift_.size(), quantities_),
        fit_s2_(spread_of_sine2(lift_.minCoeff(), 72)),
        check_s2_(spread_of_sine2(lift_.minCoeff(), 211)) {
    for (Eigen::Index i = 0; i < lift_.size(); ++i)
      for (Eigen::Index q = 0; q < quantities_; ++q) weight_(i, q) = medium.weight[std::size_t(i)][std::size_t(q)];
    fit_truth_ = kernel(fit_s2_, lift_) * weight_;
    check_truth_ = kernel(check_s2_, lift_) * weight_;
  }

  FarFit fit(Eigen::Index count) const {
    const ArrayXd node_lift = gauss_nodes(count);
    const MatrixXd basis = kernel(fit_s2_, node_lift), check_basis = kernel(check_s2_, node_lift);
    FarFit result{std::vector<FarNode>(std::size_t(node_lift.size())), 0, 0};
    for (Eigen::Index q = 0; q < quantities_; ++q) {
      const ArrayXd scale = row_scale(fit_s2_, fit_truth_.col(q), q),
                    check = row_scale(check_s2_, check_truth_.col(q), q);
      const VectorXd w = (basis.array().colwise() * scale)
                             .matrix()
                             .colPivHouseholderQr()
                             .solve((fit_truth_.col(q).array() * scale).matrix());
      const double error = ((check_basis * w - check_truth_.col(q)).array() * check).abs().maxCoeff();
      (q == 0 ? result.bending_error_rad : result.relative_error) = std::max(error, q == 0 ? 0 : result.relative_error);
      for (Eigen::Index k = 0; k < w.size(); ++k) result.nodes[std::size_t(k)].weight[std::size_t(q)] = w[k];
    }
    for (Eigen::Index k = 0; k < node_lift.size(); ++k) result.nodes[std::size_t(k)].lift = node_lift[k];
    return result;
  }

 private:
  static MatrixXd kernel(const ArrayXd &s2, const ArrayXd &lift) {
    MatrixXd m(s2.size(), lift.size());
    for (Eigen::Index j = 0; j < lift.size(); ++j) m.col(j) = (s2 + (1 - s2) * lift[j]).rsqrt().matrix();
    return m;
  }

  /// Bending counts absolutely, times cos e; the rest relatively.
  static ArrayXd row_scale(const ArrayXd &s2, const VectorXd &truth, Eigen::Index quantity) {
    if (quantity == 0) return (1 - s2).max(0).sqrt();
    return truth.array().abs().max(1e-300).inverse();
  }

  /// Lifts of the Gauss nodes in x = ln(lift) for the positive measure sum_q |weight_q| / (total_q sqrt(lift)).
  ArrayXd gauss_nodes(Eigen::Index count) const {
    ArrayXd measure = ArrayXd::Zero(lift_.size());
    for (Eigen::Index q = 0; q < quantities_; ++q) {
      const ArrayXd part = weight_.col(q).array().abs() / lift_.sqrt();
      measure += part / std::max(part.sum(), 1e-300);
    }
    const ArrayXd x = lift_.log();
    const Eigen::Index n = std::min(count, x.size());
    MatrixXd basis(x.size(), n);
    MatrixXd jacobi = MatrixXd::Zero(n, n);
    VectorXd v = measure.sqrt().matrix().normalized();
    for (Eigen::Index k = 0; k < n; ++k) {  // Lanczos, made orthogonal against all before, twice
      basis.col(k) = v;
      VectorXd next = (x * v.array()).matrix();
      jacobi(k, k) = v.dot(next);
      for (int twice = 0; twice < 2; ++twice)
        next -= basis.leftCols(k + 1) * (basis.leftCols(k + 1).transpose() * next);
      if (k + 1 == n) break;
      jacobi(k, k + 1) = jacobi(k + 1, k) = next.norm();
      v = next.normalized();
    }
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(jacobi, Eigen::EigenvaluesOnly).eigenvalues().array().exp();
  }

  Eigen::Index quantities_;
  ArrayXd lift_;
  MatrixXd weight_;
  ArrayXd fit_s2_, check_s2_;
  MatrixXd fit_truth_, check_truth_;
};

constexpr std::size_t panel_nodes = 8;
constexpr double panel_width = 0.25;  // of ln(lift)

/// Chebyshev nodes of -1..1 and Lagrange's polynomials on them.
std::array<double, panel_nodes> chebyshev_nodes() {
  std::array<double, panel_nodes> t{};
  for (std::size_t j = 0; j < panel_nodes; ++j) t[j] = -std::cos(pi * (double(j) + 0.5) / panel_nodes);
  return t;
}

std::array<double, panel_nodes> lagrange(const std::array<double, panel_nodes> &nodes, double t) {
  std::array<double, panel_nodes> value{};
  for (std::size_t j = 0; j < panel_nodes; ++j) {
    value[j] = 1;
    for (std::size_t k = 0; k < panel_nodes; ++k)
      if (k != j) value[j] *= (t - nodes[k]) / (nodes[j] - nodes[k]);
  }
  return value;
}

}  // namespace

FarMedium compressed(const FarMedium &medium) {
  static const std::array<double, panel_nodes> nodes = chebyshev_nodes();
  const double first = std::log(*std::min_element(medium.lift.begin(), medium.lift.end()));
  const double last = std::log(*std::max_element(medium.lift.begin(), medium.lift.end()));
  const auto panels = static_cast<std::size_t>((last - first) / panel_width) + 1;
  if (panels * panel_nodes >= medium.lift.size()) return medium;
  FarMedium few;
  for (std::size_t p = 0; p < panels; ++p)
    for (double t : nodes) few.lift.push_back(std::exp(first + panel_width * (double(p) + 0.5 * (t + 1))));
  few.weight.resize(few.lift.size());
  for (std::size_t i = 0; i < medium.lift.size(); ++i) {
    const double at = (std::log(medium.lift[i]) - first) / panel_width;
    const std::size_t p = std::min(static_cast<std::size_t>(std::max(at, 0.0)), panels - 1);
    const std::array<double, panel_nodes> share = lagrange(nodes, 2 * (at - double(p)) - 1);
    for (std::size_t j = 0; j < panel_nodes; ++j)
      for (std::size_t q = 0; q < medium.weight[i].size(); ++q)
        few.weight[p * panel_nodes + j][q] += share[j] * medium.weight[i][q];
  }
  return few;
}

FarFit fit_far(const FarMedium &medium, std::size_t count, bool bending_only) {
  return FarFitter(medium, bending_only).fit(Eigen::Index(count));
}

std::vector<FarNode> merge_far(const FarMedium &medium, double error_rad, double relative_error, bool bending_only,
                               std::size_t most) {
  const FarFitter fitter(medium, bending_only);
  for (std::size_t count = 4; count <= most; count += 4) {
    FarFit fit = fitter.fit(Eigen::Index(count));
    if (fit.bending_error_rad <= error_rad && fit.relative_error <= relative_error) return fit.nodes;
  }
  return {};
}

}  // namespace greenray
