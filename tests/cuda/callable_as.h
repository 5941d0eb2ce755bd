// SPDX-License-Identifier: MIT
// Whether a call can use the adaptor's own declaration instead of the one in NVIDIA's headers.
#pragma once

#include <type_traits>

template<class T>
inline constexpr bool is_call = std::is_pointer_v<T>&& std::is_function_v<std::remove_pointer_t<T>>;

/// A class that is used only through pointers matches itself or an incomplete class.
template<class Ours, class Theirs>
constexpr bool same_class() {
    if constexpr (std::is_same_v<Ours, Theirs>)
        return true;
    else
        return sizeof(Ours) == sizeof(Theirs) && alignof(Ours) == alignof(Theirs);
}

template<class... Ours, class OurReturn, class... Theirs, class Return>
constexpr bool callable_as(OurReturn (*)(Ours...), Return (*)(Theirs...));

/// Whether one type can replace the other in a call: our int for their enumerations, our byte pointer for
/// theirs to a structure, an enumeration for another, and a structure for another of its size. All other
/// types must be equal.
template<class Ours, class Theirs>
constexpr bool stands_for() {
    if constexpr (std::is_enum_v<Theirs>)
        return (std::is_same_v<Ours, int> || std::is_enum_v<Ours>)&&sizeof(Theirs) == sizeof(Ours);
    else if constexpr (std::is_class_v<Theirs> && std::is_class_v<Ours>)
        return same_class<Ours, Theirs>();
    else if constexpr (is_call<Theirs> && is_call<Ours>)
        return callable_as(Ours{}, Theirs{});
    else if constexpr (std::is_pointer_v<Theirs> && std::is_pointer_v<Ours>)
        return std::is_same_v<
                   std::remove_cv_t<std::remove_pointer_t<Ours>>,
                   unsigned char> || stands_for<std::remove_pointer_t<Ours>, std::remove_pointer_t<Theirs>>();
    else
        return std::is_same_v<std::remove_cv_t<Ours>, std::remove_cv_t<Theirs>>;
}

template<class... Ours, class OurReturn, class... Theirs, class Return>
constexpr bool callable_as(OurReturn (*)(Ours...), Return (*)(Theirs...)) {
    if constexpr (sizeof...(Ours) != sizeof...(Theirs))
        return false;
    else
        return stands_for<OurReturn, Return>() && (stands_for<Ours, Theirs>() && ...);
}
