// How well each hypothesis explains a linear problem: evidence by Gaussian integrals over all
// parameters. A hypothesis differs from the others by the priors of its own parameters only.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/evidence/normal_sums.h"
#include "diagnosis/evidence/priors.h"

namespace flextip::diagnosis {

/// What is thought present: effects by their place in the priors (none: within specification), and
/// whether something is that the catalogue does not hold.
struct Hypothesis {
  std::vector<int> effects;
  bool unknown = false;
  bool operator==(const Hypothesis&) const = default;
};

struct WeighedHypothesis {
  Hypothesis hypothesis;
  double log_evidence = 0.0;   ///< against `none`, averaged over the widths of its prior
  std::vector<double> scales;  ///< the widths that explain best, one an effect
  double unknown_sd = 0.0;     ///< likewise of the generic terms
};

struct EvidenceOptions {
  std::vector<double> scales{0.3, 1.0, 3.0};           ///< of an effect's typical size
  std::vector<double> unknown_sd{0.1, 0.3, 1.0, 3.0};  ///< of generic terms, in noise sd
};

class Evidence {
 public:
  /// `generic_sd`: prior of each generic coefficient while nothing unknown is present.
  Evidence(const NormalSums& sums, const Priors& priors, const Eigen::VectorXd& generic_sd,
           const EvidenceOptions& options = {});

  WeighedHypothesis Weigh(const Hypothesis& hypothesis) const;

  /// log evidence of `none` itself, up to a constant of the measurements: comparable between
  /// problems made about different points.
  double LogEvidenceOfNone() const { return none_; }

  /// Of all unknowns given that `weighed` holds, with its best widths.
  Eigen::MatrixXd Covariance(const WeighedHypothesis& weighed) const;
  /// The most likely unknowns then; `covariance`: Covariance(weighed).
  Eigen::VectorXd Mode(const WeighedHypothesis& weighed, const Eigen::MatrixXd& covariance) const;
  /// Minus twice the log of how likely the unknowns `x` are under `weighed`, up to the constant
  /// that LogEvidenceOfNone leaves out too.
  double Merit(const WeighedHypothesis& weighed, const Eigen::VectorXd& x) const;
  /// Standard deviations of all unknowns' priors under `weighed`.
  Eigen::VectorXd PriorSd(const WeighedHypothesis& weighed) const;

 private:
  /// All unknowns with the catalogue's parameters at their tolerances.
  struct Context {
    double unknown_sd = 0.0;     ///< of the generic terms; 0: their narrow prior
    Eigen::VectorXd sd;          ///< prior
    Eigen::MatrixXd covariance;  ///< posterior, in units of sd
    Eigen::VectorXd mean;        ///< likewise
    double log_evidence = 0.0;   ///< against the first context
  };
  Context MakeContext(double unknown_sd) const;
  struct Marginal {
    Eigen::MatrixXd A;    ///< posterior precision of the subset
    Eigen::VectorXd eta;  ///< information vector
    double base = 0.0;
  };
  static Marginal MarginalOf(const Context& context, const std::vector<int>& subset);
  double Change(const Marginal& marginal, const Eigen::VectorXd& wide,
                const std::vector<int>& subset) const;
  std::vector<int> Subset(const Hypothesis& hypothesis) const;
  Eigen::VectorXd WideSd(const std::vector<int>& subset, const Hypothesis& hypothesis,
                         const std::vector<double>& scales) const;

  const NormalSums& sums_;
  const Priors& priors_;
  EvidenceOptions options_;
  Eigen::VectorXd narrow_;  // prior sd of all unknowns under `none`
  double none_ = 0.0;
  std::vector<Context> contexts_;  // nothing unknown, then each of the unknown's widths
};

/// log(sum(exp(x))).
double LogSumExp(const std::vector<double>& x);

}  // namespace flextip::diagnosis
