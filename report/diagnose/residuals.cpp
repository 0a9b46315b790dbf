#include "report/diagnose/residuals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/median.h"
#include "report/diagnose/words.h"

namespace flextip::report {
namespace {

constexpr std::size_t kPoints = 1500;  ///< most points of a trace, so that the page stays small
constexpr std::size_t kBins = 20;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kBaseColor = "#d55e00";
constexpr const char* kExtendedColor = "#0072b2";

constexpr const char* kModels[] = {"base", "extended"};

struct Points {
  std::vector<double> x, y;
};

const std::vector<double>* Component(const ResultTable& table, const std::string& model,
                                     const std::string& channel, std::size_t i) {
  return table.Column(fmt::format("{}.{}.{}", model, channel, i));
}

/// Rows where both are there.
Points Paired(const std::vector<double>* x, const std::vector<double>* y) {
  Points points;
  if (x == nullptr || y == nullptr) return points;
  for (std::size_t i = 0; i < x->size(); ++i) {
    if (!std::isfinite((*x)[i]) || !std::isfinite((*y)[i])) continue;
    points.x.push_back((*x)[i]);
    points.y.push_back((*y)[i]);
  }
  return points;
}

/// Where nothing was found, the extended model is the base simulation.
bool AreSame(const ResultTable& table, const std::string& channel, std::size_t i) {
  const auto* t = table.Column("t_s");
  return Paired(t, Component(table, kModels[0], channel, i)).y ==
         Paired(t, Component(table, kModels[1], channel, i)).y;
}

/// Every n-th point.
Points Thinned(const Points& all) {
  const std::size_t step = (all.x.size() + kPoints - 1) / kPoints;
  if (step <= 1) return all;
  Points few;
  for (std::size_t i = 0; i < all.x.size(); i += step) {
    few.x.push_back(all.x[i]);
    few.y.push_back(all.y[i]);
  }
  return few;
}

/// The lowest and the highest point of each stretch, so that a short spike stays in the picture.
Points Outline(const Points& all) {
  const std::size_t step = 2 * all.x.size() / kPoints + 1;
  if (all.x.size() <= kPoints) return all;
  Points few;
  for (std::size_t i = 0; i < all.x.size(); i += step) {
    const auto begin = all.y.begin() + std::ptrdiff_t(i);
    const auto end = all.y.begin() + std::ptrdiff_t(std::min(i + step, all.y.size()));
    auto [low, high] = std::minmax_element(begin, end);
    for (const auto it : {std::min(low, high), std::max(low, high)}) {
      few.x.push_back(all.x[std::size_t(it - all.y.begin())]);
      few.y.push_back(*it);
    }
  }
  return few;
}

/// Means of y in bins of equally many points, over the means of x.
Points BinMeans(const Points& points) {
  std::vector<std::size_t> order(points.x.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return points.x[a] < points.x[b]; });
  const std::size_t bins = std::min(kBins, points.x.size() / 8);
  Points means;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t begin = b * order.size() / bins, end = (b + 1) * order.size() / bins;
    double x = 0.0, y = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      x += points.x[order[i]] / double(end - begin);
      y += points.y[order[i]] / double(end - begin);
    }
    means.x.push_back(x);
    means.y.push_back(y);
  }
  return means;
}

double Variance(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
  double sum = 0.0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return sum / double(values.size());
}

/// Two dashed lines at y = -+`height` over the range of x.
FigureTrace Band(const std::string& name, double low, double high, double height) {
  return {.name = name,
          .x = {low, high, kNan, low, high},
          .y = {height, height, kNan, -height, -height},
          .color = "#5b6877",
          .dashed = true};
}

std::string ComponentLabel(const ResultTable& table, const std::string& channel, std::size_t i) {
  const std::size_t count = ComponentCount(table, "base", channel);
  const DiagnosedParameter as_list{
      .effect = channel, .value = std::vector<double>(count), .is_list = count > 1};
  const std::string component = ComponentName(as_list, i);
  return SpokenChannel(channel) + (component.empty() ? "" : ", " + component);
}

/// Regressors that stand in SI without a unit in their name.
ShownUnit RegressorUnit(const std::string& name) {
  if (name == "time") return {.name = "time", .unit = "s"};
  if (name.starts_with("insertion")) return {"insertion depth", "mm", 1e3};
  if (name == "sliding_velocity" || name == "wrist_speed")
    return {SpokenHypothesis(name), "mm/s", 1e3};
  if (name == "load" || name == "port_force") return {SpokenHypothesis(name), "N", 1.0};
  return ShownUnitOf(name);
}

/// Sum of products `lag` apart over the sum of squares, mean over components.
std::vector<double> Autocorrelation(const std::vector<std::vector<double>>& components,
                                    std::size_t lags) {
  std::vector<double> mean(lags, 0.0);
  for (const auto& y : components) {
    const double centre = std::accumulate(y.begin(), y.end(), 0.0) / double(y.size());
    double squares = 0.0;
    for (const double v : y) squares += (v - centre) * (v - centre);
    for (std::size_t lag = 1; lag <= lags && squares > 0.0; ++lag) {
      double sum = 0.0;
      for (std::size_t i = lag; i < y.size(); ++i) sum += (y[i] - centre) * (y[i - lag] - centre);
      mean[lag - 1] += sum / squares / double(components.size());
    }
  }
  return mean;
}

double MedianStep(std::vector<double> t) {
  if (t.size() < 2) return 0.0;
  for (std::size_t i = t.size() - 1; i > 0; --i) t[i] -= t[i - 1];
  t.erase(t.begin());
  return Median(std::move(t));
}

}  // namespace

const std::vector<double>* RegressorColumn(const ResultTable& residuals, const std::string& name) {
  if (const auto* column = residuals.Column(name)) return column;
  if (name == "time" || name == "t") return residuals.Column("t_s");
  const auto it = std::find_if(residuals.names.begin(), residuals.names.end(),
                               [&](const auto& n) { return n.starts_with(name + "_"); });
  return it == residuals.names.end()
             ? nullptr
             : &residuals.numbers[std::size_t(it - residuals.names.begin())];
}

std::size_t ComponentCount(const ResultTable& residuals, const std::string& model,
                           const std::string& channel) {
  std::size_t count = 0;
  while (Component(residuals, model, channel, count) != nullptr) ++count;
  return count;
}

std::vector<std::string> ResidualChannels(const ResultTable& residuals) {
  std::vector<std::string> channels;
  for (const auto& name : residuals.names) {
    if (!name.starts_with("base.") || !name.ends_with(".0")) continue;
    const std::string channel = name.substr(5, name.size() - 7);
    if (Component(residuals, "extended", channel, 0) != nullptr) channels.push_back(channel);
  }
  return channels;
}

std::optional<double> ResidualRms(const ResultTable& residuals, const std::string& model,
                                  const std::string& channel) {
  double sum = 0.0;
  long count = 0;
  for (std::size_t i = 0; i < ComponentCount(residuals, model, channel); ++i) {
    for (const double v : *Component(residuals, model, channel, i)) {
      if (!std::isfinite(v)) continue;
      sum += v * v;
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(sum / double(count));
}

std::size_t TellingComponent(const ResultTable& residuals, const DiagnosedSignature& signature) {
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < ComponentCount(residuals, "base", signature.channel); ++i) {
    const auto points = Paired(RegressorColumn(residuals, signature.against),
                               Component(residuals, "base", signature.channel, i));
    const double between = Variance(BinMeans(points).y);
    if (between > most) {
      most = between;
      best = i;
    }
  }
  return best;
}

std::optional<Figure> SignaturePlot(const ResultTable& residuals,
                                    const DiagnosedSignature& signature) {
  const auto* x = RegressorColumn(residuals, signature.against);
  const std::size_t i = TellingComponent(residuals, signature);
  const auto unit = RegressorUnit(signature.against);
  const std::string what = ComponentLabel(residuals, signature.channel, i);
  Figure plot{.title = fmt::format("The strongest pattern: {} against {}", what, unit.name),
              .caption =
                  "Residual in standard deviations of the channel's noise. Lines: means of 20 "
                  "bins. Between the dashed lines lie 95 % of noise alone.",
              .x_label = unit.unit.empty() ? unit.name : unit.name + " (" + unit.unit + ")",
              .y_label = "residual / noise"};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  std::vector<FigureTrace> means;
  for (const auto& [model, color, faint] :
       {std::tuple{kModels[0], kBaseColor, "rgba(213,94,0,0.35)"},
        std::tuple{kModels[1], kExtendedColor, "rgba(0,114,178,0.35)"}}) {
    auto points = Paired(x, Component(residuals, model, signature.channel, i));
    if (points.x.empty()) return std::nullopt;
    if (model == kModels[1] && AreSame(residuals, signature.channel, i)) continue;
    for (double& v : points.x) v *= unit.per_si;
    const auto [least, most] = std::minmax_element(points.x.begin(), points.x.end());
    low = std::min(low, *least);
    high = std::max(high, *most);
    const auto few = Thinned(points), bins = BinMeans(points);
    plot.traces.push_back({.name = model,
                           .kind = FigureTrace::Kind::kPoints,
                           .x = few.x,
                           .y = few.y,
                           .color = faint});
    means.push_back(
        {.name = std::string(model) + ", mean", .x = bins.x, .y = bins.y, .color = color});
  }
  for (auto& mean : means) plot.traces.push_back(std::move(mean));
  plot.traces.push_back(Band("noise (95 %)", low, high, 1.96));
  return plot;
}

std::optional<Figure> TimePlot(const ResultTable& residuals, const DiagnosedSignature& signature) {
  const auto* t = residuals.Column("t_s");
  const std::size_t i = TellingComponent(residuals, signature);
  Figure plot{.title = ComponentLabel(residuals, signature.channel, i) + " over time",
              .x_label = "time (s)",
              .y_label = "residual / noise"};
  for (const auto& [model, color] :
       {std::pair{kModels[0], kBaseColor}, std::pair{kModels[1], kExtendedColor}}) {
    const auto points = Outline(Paired(t, Component(residuals, model, signature.channel, i)));
    if (points.x.empty()) return std::nullopt;
    if (model == kModels[1] && AreSame(residuals, signature.channel, i)) continue;
    plot.traces.push_back({.name = model, .x = points.x, .y = points.y, .color = color});
  }
  const auto& x = plot.traces.front().x;
  plot.traces.push_back(Band("noise (95 %)", x.front(), x.back(), 1.96));
  return plot;
}

Memory ResidualMemory(const ResultTable& residuals, const std::string& model) {
  constexpr std::size_t kLags = 40;
  Memory memory{.plot = {.title = "Does what is left remember itself?",
                         .x_label = "lag (s)",
                         .y_label = "autocorrelation"}};
  double widest = 0.0, longest = 0.0;
  for (const auto& channel : ResidualChannels(residuals)) {
    std::vector<std::vector<double>> components;
    std::vector<double> t;
    for (std::size_t i = 0; i < ComponentCount(residuals, model, channel); ++i) {
      auto points = Paired(residuals.Column("t_s"), Component(residuals, model, channel, i));
      t = std::move(points.x);
      if (t.size() >= 20 && Variance(points.y) > 0.0) components.push_back(std::move(points.y));
    }
    if (components.empty()) continue;
    const std::size_t n = components.front().size(), lags = std::min(kLags, n / 4);
    const auto correlation = Autocorrelation(components, lags);
    const double step = MedianStep(t), band = 1.96 / std::sqrt(double(n));
    FigureTrace trace{.name = SpokenChannel(channel), .y = correlation};
    for (std::size_t lag = 1; lag <= lags; ++lag) trace.x.push_back(step * double(lag));
    // The largest of 40 lags of white noise stays within twice the band.
    const auto strongest =
        *std::max_element(correlation.begin(), correlation.end(),
                          [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (std::abs(strongest) > 2.0 * band) {
      memory.not_white.push_back(fmt::format("{} ({:.2f})", trace.name, strongest));
    }
    widest = std::max(widest, band);
    longest = std::max(longest, trace.x.back());
    memory.plot.traces.push_back(std::move(trace));
  }
  if (!memory.plot.traces.empty()) {
    memory.plot.traces.push_back(Band("white noise (95 %)", 0.0, longest, widest));
  }
  return memory;
}

}  // namespace flextip::report
