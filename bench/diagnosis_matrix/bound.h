// The least standard deviation that a recording allows its effects' parameters.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "bench/diagnosis_matrix/true_model.h"
#include "diagnosis/diagnose.h"

namespace flextip::bench {

/// (H + diag(1 / prior_sd^2))^-1.
Eigen::MatrixXd PosteriorCovariance(const Eigen::MatrixXd& H, const Eigen::VectorXd& prior_sd);

/// The Cramer-Rao bound of a Bayesian (van Trees 1968) of each present effect's parameters, about
/// the true ones and in the terms they are reported in: values of the truth, `sd` the bound. Who
/// reaches it knows which effects are present (their priors wide: WidePrior), that all others are
/// within tolerance and the frames within their registration's noise, that the model's form is
/// exact (no generic terms), and that noise is as the recording states it. Without load0 each
/// sample's tip force is unknown. Noise that smoothing left on the wrist's path and on the load
/// counts as white, as it does in the diagnosis. Empty where the model has no equilibrium.
std::vector<diagnosis::EffectFit> CramerRaoBounds(TrueModel& truth);

}  // namespace flextip::bench
