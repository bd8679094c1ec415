#include "reproduce/reproduction.hpp"

// The list: a figure or table is NAME.cpp in this folder, or a function NAME in a file that several share,
// and defines `Reproducible NAME()`.
#define TWINCELL_REPRODUCTIONS(EACH) \
  EACH(p1_fig1)                      \
  EACH(p1_fig2)                      \
  EACH(p1_fig3)                      \
  EACH(p1_fig4)                      \
  EACH(p1_fig5)                      \
  EACH(p1_table1)                    \
  EACH(p1_appendix)                  \
  EACH(p1_step)                      \
  EACH(p1_truncate)                  \
  EACH(p2_fig2)                      \
  EACH(p2_fig3)                      \
  EACH(p2_fig4)                      \
  EACH(p2_fig5)                      \
  EACH(p2_fig6)                      \
  EACH(p2_fig7)                      \
  EACH(p2_fig8)                      \
  EACH(p2_fig9)                      \
  EACH(p2_fig10)                     \
  EACH(p2_fig11)                     \
  EACH(p2_fig12)                     \
  EACH(p2_fig13)                     \
  EACH(p2_fig14)                     \
  EACH(p2_fig15)                     \
  EACH(p2_fig16)                     \
  EACH(p2_table1)                    \
  EACH(p2_table2)                    \
  EACH(p2_table3)                    \
  EACH(p2_excess)

namespace twincell::reproduce {

#define TWINCELL_DECLARE(name) Reproducible name();
TWINCELL_REPRODUCTIONS(TWINCELL_DECLARE)
#undef TWINCELL_DECLARE

const std::vector<Reproducible>& list() {
#define TWINCELL_ENTRY(name) name(),
  static const std::vector<Reproducible> all = {TWINCELL_REPRODUCTIONS(TWINCELL_ENTRY)};
#undef TWINCELL_ENTRY
  return all;
}

}  // namespace twincell::reproduce
