// The part of ghc_controller.core.native that answers control problems.
#pragma once

#include <nanobind/nanobind.h>

namespace ghc {

void bind_solve(nanobind::module_& m);
void bind_step(nanobind::module_& m);

}  // namespace ghc
