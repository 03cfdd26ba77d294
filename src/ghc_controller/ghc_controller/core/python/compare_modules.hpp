// The parts of ghc_controller.core.native behind formulations that are written in Python.
#pragma once

#include <nanobind/nanobind.h>

namespace ghc::python {

void bind_formulations(nanobind::module_& m);
void bind_qp(nanobind::module_& m);
void bind_motions(nanobind::module_& m);
void bind_plans(nanobind::module_& m);

}  // namespace ghc::python
