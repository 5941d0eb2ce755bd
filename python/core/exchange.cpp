// SPDX-License-Identifier: MIT
#include "python/core/exchange.h"

namespace nb = nanobind;

namespace tandem::python {

namespace {

/// DLPackExchangeAPI of dlpack.h, version 1.
struct Table {
    std::uint32_t major, minor;
    const Table* older;
    void* allocate;
    int (*from_object)(void* object, void** tensor);
    void* to_object;
    void* view;
    int (*current_stream)(int device_type, std::int32_t device_id, void** stream);
};

/// First members of DLManagedTensorVersioned of dlpack.h, equal in every version.
struct Tensor {
    std::uint32_t major, minor;
    void* context;
    void (*deleter)(Tensor*);
};

constexpr const char* tensor_name = "dltensor_versioned";

void drop(PyObject* capsule) {
    if (PyCapsule_IsValid(capsule, tensor_name) == 0) return; // renamed by a consumer that owns the tensor
    auto* const tensor = static_cast<Tensor*>(PyCapsule_GetPointer(capsule, tensor_name));
    if (tensor->deleter != nullptr) tensor->deleter(tensor);
}

PyObject* attribute(PyObject* object, PyObject* name) {
    auto* const value = PyObject_GetAttr(object, name);
    if (value == nullptr) PyErr_Clear();
    return value;
}

const Table* table_of(nb::handle type) {
    static auto* const name = PyUnicode_InternFromString("__dlpack_c_exchange_api__");
    const auto capsule = nb::steal(attribute(type.ptr(), name));
    if (!capsule || !PyCapsule_IsValid(capsule.ptr(), "dlpack_exchange_api")) return nullptr;
    auto* table = static_cast<const Table*>(PyCapsule_GetPointer(capsule.ptr(), "dlpack_exchange_api"));
    while (table != nullptr && table->major != 1) table = table->older;
    return table;
}

/// PyTorch's table exports arrays that require a gradient, which its __dlpack__ refuses.
bool has_gradient(nb::handle array) {
    static auto* const name = PyUnicode_InternFromString("requires_grad");
    const auto value = nb::steal(attribute(array.ptr(), name));
    return value.ptr() == Py_True;
}

} // namespace

std::optional<Exchanged> exchanged(nb::handle array) {
    const auto* const table = table_of(array.type());
    if (table == nullptr || has_gradient(array)) return std::nullopt;
    void* tensor = nullptr;
    if (table->from_object(array.ptr(), &tensor) != 0) {
        PyErr_Clear();
        return std::nullopt;
    }
    const auto capsule = nb::steal(PyCapsule_New(tensor, tensor_name, drop));
    Exchanged given;
    if (!nb::try_cast(capsule, given.array)) return std::nullopt;
    if (table->current_stream(given.array.device_type(), given.array.device_id(), &given.stream) != 0) {
        PyErr_Clear();
        return std::nullopt;
    }
    return given;
}

} // namespace tandem::python
