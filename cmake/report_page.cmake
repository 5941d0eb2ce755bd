# SPDX-License-Identifier: MIT
# tandem_report_page(TARGET): the files of `tandem report`'s page as part of a target: its own (harness/report/page) and the
# libraries that draw charts and scenes. The assembler puts them into the program; as literals they would take a compiler
# minutes. Without a library the program is built all the same, and says what to install.
set(TANDEM_JAVASCRIPT /usr/share/javascript CACHE PATH "Folder with three and chart.js (Debian: libjs-three, libjs-chart.js)")

function(tandem_report_page target)
  file(GLOB own CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/harness/report/page/*)
  set(files ${own})
  foreach(library chart.js/chart.min.js three/three.min.js three/examples/js/controls/OrbitControls.js)
    if(EXISTS ${TANDEM_JAVASCRIPT}/${library})
      list(APPEND files ${TANDEM_JAVASCRIPT}/${library})
    else()
      message(STATUS "no ${TANDEM_JAVASCRIPT}/${library}: tandem report and view say how to get it (Debian: libjs-three, libjs-chart.js)")
    endif()
  endforeach()
  set(bytes)
  set(names)
  set(cases)
  foreach(file ${files})
    cmake_path(GET file FILENAME name)
    string(MAKE_C_IDENTIFIER "tandem_page_${name}" symbol)
    string(APPEND bytes ".global ${symbol}, ${symbol}_end\n${symbol}: .incbin \"${file}\"\n${symbol}_end: .byte 0\n")
    string(APPEND names "extern const char ${symbol}[], ${symbol}_end[];\n")
    string(APPEND cases "    if (name == \"${name}\") return {${symbol}, ${symbol}_end};\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/report_assets.cpp @ONLY CONTENT [=[
#include "harness/report/assets.h"
asm(R"(.pushsection .rodata
@bytes@.popsection
)");
extern "C" {
@names@}
namespace tandem::report {
std::string_view asset(std::string_view name) {
@cases@    return {};
}
} // namespace tandem::report
]=])
  target_sources(${target} PRIVATE ${PROJECT_BINARY_DIR}/report_assets.cpp)
  set_source_files_properties(${PROJECT_BINARY_DIR}/report_assets.cpp PROPERTIES OBJECT_DEPENDS "${files}" SKIP_PRECOMPILE_HEADERS ON)
endfunction()
