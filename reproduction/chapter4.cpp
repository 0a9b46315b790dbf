#include "reproduction/chapter.h"
#include <fmt/format.h>
#include "reproduction/ch4_steps.h"
namespace flextip {
ChapterResult ReproduceChapter4(const ReproduceOptions& /*options*/, const ChapterProgress& progress) {
  Ch4Move m;
  m.setup.instrument = {0.6, 0.00238, 0.304, 0};
  m.setup.p_RP = {0.28, 0, 0};
  PlantSetup ps; ps.instrument = m.setup.instrument; ps.p_RP = m.setup.p_RP; ps.load.constant_N = {0, -2, 0};
  Ch4Plant plants[2] = {Ch4Plant::Beam(m.setup.instrument, m.setup.p_RP, -2), Ch4Plant::Exact(ps)};
  for (auto& p : plants) { const auto s = p.At({0,0,0}); fmt::print("tip {} {} port from tip {} {}\n", s->p_RE.x(), s->p_RE.y(), 0.28 - s->p_RE.x(), -s->p_RE.y()); }
  const Eigen::Vector3d dirs[4] = {{0.01,0,0},{-0.01,0,0},{0,0.01,0},{0,-0.01,0}};
  for (int n = 0; n < 4; ++n) for (auto& p : plants) for (auto k : kCh4Kinds) {
    fmt::print("noise {} {:40s}", n, Name(k));
    m.kind = k;
    if (n == 1) m.noise = {true, 0.0018, 0.0087, false, 1};
    if (n == 2) m.noise = {true, 0.0018, 0.0087, true, 1};
    if (n == 3) m.noise = {true, 0.0018, 0.0087, true, 60};
    m.reached_m = n ? 0.0005 : 5e-5;
    for (auto& d : dirs) { m.move_m = d; double mx=0, s=0, ms=0; int u=0, si=0, lost=0; const int N = n ? 20 : 1; for (int i=0;i<N;++i) { m.seed = 100+i; const auto r = RunCh4Move(m, p); s += r.max_m; ms += r.max_measured_m; mx = std::max(mx, r.max_m); u += r.updates; si += r.straight_instead; lost += r.lost; }
      fmt::print(" {:.3f}/{:.2f}/{:.2f} u{} s{} l{}|", 1e3*s/N, 1e3*mx, 1e3*ms/N, u/N, si, lost); }
    fmt::print("\n");
  }
  progress(1.0);
  return {};
}
}
