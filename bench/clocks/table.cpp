#include "bench/clocks/table.h"

#include <fmt/format.h>

#include <cmath>

#include "core/median.h"

namespace flextip::bench {

std::vector<ClockRow> MeasureSession(const ClockSession& session) {
  std::vector<ClockRow> rows;
  for (const StreamClock& clock : AlignClocks(session.recording).streams) {
    const TrueClock& truth = session.clocks.at(clock.stream);
    ClockRow row{.session = session.name, .stream = clock.stream};
    row.found = clock.IsUsable();
    row.reason = clock.reason;
    row.error_s = clock.offset_s - truth.OffsetAt(clock.origin_ns);
    row.sd_s = std::sqrt(clock.covariance(0, 0));
    row.rate_error = clock.rate - truth.rate;
    row.rate_sd = std::sqrt(clock.covariance(1, 1));
    rows.push_back(row);
  }
  return rows;
}

std::string MarkdownHead() {
  return "| session | stream | n | median (ms) | 95 % (ms) | within 2 ms | within 2 sd | both | "
         "refused | rate within 2 sd | median sd (ms) |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|\n";
}

std::string MarkdownLines(const std::string& kind, const std::vector<ClockRow>& rows) {
  std::string lines;
  for (const std::string stream : {"em0", "vision0", "strain0", "load0"}) {
    std::vector<double> errors, sds;
    double all = 0.0, near = 0.0, honest = 0.0, both = 0.0, rate = 0.0;
    for (const ClockRow& row : rows) {
      if (row.stream != stream) continue;
      ++all;
      if (!row.found) continue;
      errors.push_back(1e3 * std::abs(row.error_s));
      sds.push_back(1e3 * row.sd_s);
      const bool is_near = std::abs(row.error_s) <= 0.002;
      const bool is_honest = std::abs(row.error_s) <= 2.0 * row.sd_s;
      near += is_near;
      honest += is_honest;
      both += is_near && is_honest;
      rate += std::abs(row.rate_error) <= 2.0 * row.rate_sd;
    }
    if (all == 0.0) continue;
    const double found = static_cast<double>(errors.size());
    if (errors.empty()) {
      lines += fmt::format("| {} | {} | {} | | | | | | 100 % | | |\n", kind, stream, all);
      continue;
    }
    const auto share = [&](double part) { return 100.0 * part / found; };
    lines += fmt::format(
        "| {} | {} | {} | {:.2f} | {:.2f} | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % | "
        "{:.2f} |\n",
        kind, stream, all, Median(errors), Quantile(errors, 0.95), share(near), share(honest),
        share(both), 100.0 * (all - found) / all, share(rate), Median(sds));
  }
  return lines;
}

}  // namespace flextip::bench
