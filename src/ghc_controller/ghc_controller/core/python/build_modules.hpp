// The parts of ghc_controller.core.native that build a control problem.
#pragma once

#include <nanobind/nanobind.h>

namespace ghc::python {

void bind_model(nanobind::module_& m);
void bind_tasks(nanobind::module_& m);
void bind_bodies(nanobind::module_& m);
void bind_boxes(nanobind::module_& m);
void bind_contacts(nanobind::module_& m);

}  // namespace ghc::python
