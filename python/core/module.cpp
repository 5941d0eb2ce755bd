// SPDX-License-Identifier: MIT
// tandem._core, the compiled part of the Python package. Users call python/tandem/collider.py.
#include "python/core/answer.h"
#include "python/core/collider.h"
#include "python/core/devices.h"
#include "python/core/errors.h"
#include "python/core/meshes.h"
#include "python/core/queued.h"
#include "python/core/scenes.h"

NB_MODULE(_core, module) {
    module.doc() = "The library tandem for Python. Use tandem.Collider.";
    tandem::python::bind_errors(module);
    tandem::python::bind_devices(module);
    tandem::python::bind_meshes(module);
    tandem::python::bind_scenes(module);
    tandem::python::bind_answer(module);
    tandem::python::bind_queued(module);
    tandem::python::bind_collider(module);
}
