#include "report/embedded/embedded.h"

// The assembler copies each file between two symbols. The build gives the paths and rebuilds this
// file when one of them changes.
#define FLEXTIP_EMBED(symbol, path)         \
  asm(".section .rodata\n"                  \
      ".global " #symbol "_begin\n" #symbol \
      "_begin:\n"                           \
      ".incbin \"" path                     \
      "\"\n"                                \
      ".global " #symbol "_end\n" #symbol   \
      "_end:\n"                             \
      ".byte 0\n"                           \
      ".previous\n");                       \
  extern "C" const char symbol##_begin[];   \
  extern "C" const char symbol##_end[]

FLEXTIP_EMBED(flextip_plotly_js, FLEXTIP_PLOTLY_JS);
FLEXTIP_EMBED(flextip_plotly_flat_js, FLEXTIP_PLOTLY_FLAT_JS);
FLEXTIP_EMBED(flextip_page_css, FLEXTIP_PAGE_CSS);
FLEXTIP_EMBED(flextip_figures_js, FLEXTIP_FIGURES_JS);
FLEXTIP_EMBED(flextip_tables_js, FLEXTIP_TABLES_JS);

namespace flextip::report {
namespace {

std::string_view Between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view PlotlyJs() { return Between(flextip_plotly_js_begin, flextip_plotly_js_end); }
std::string_view PlotlyFlatJs() {
  return Between(flextip_plotly_flat_js_begin, flextip_plotly_flat_js_end);
}
std::string_view PageCss() { return Between(flextip_page_css_begin, flextip_page_css_end); }
std::string_view FiguresJs() { return Between(flextip_figures_js_begin, flextip_figures_js_end); }
std::string_view TablesJs() { return Between(flextip_tables_js_begin, flextip_tables_js_end); }

}  // namespace flextip::report
