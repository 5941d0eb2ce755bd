# SPDX-License-Identifier: MIT
# Sets TANDEM_BUILDS_PYTHON: whether the compiled part of the Python package is built. Include it before the library's
# targets, because a shared module needs position-independent code.
set(TANDEM_PYTHON AUTO CACHE STRING "Build the Python module: ON, OFF, or AUTO (where nanobind and Python's headers are installed)")
set(TANDEM_BUILDS_PYTHON OFF)
if(TANDEM_PYTHON STREQUAL AUTO AND TANDEM_SANITIZE)
  return() # a sanitized module needs a sanitized interpreter
endif()
if(TANDEM_PYTHON)
  # The interpreter that runs the tests. pip builds for its own one.
  if(NOT SKBUILD AND NOT DEFINED Python_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python_EXECUTABLE /usr/bin/python3)
  endif()
  if(SKBUILD)
    message(NOTICE "tandem: compiling the library takes about three minutes on two cores")
  endif()
  set(required)
  if(NOT TANDEM_PYTHON STREQUAL AUTO)
    set(required REQUIRED)
  endif()
  find_package(Python 3.11 ${required} COMPONENTS Interpreter Development.Module)
  find_package(nanobind CONFIG ${required} PATHS ${PROJECT_SOURCE_DIR}/.cache/python/nanobind/cmake) # scripts/setup puts it there
  if(Python_Development.Module_FOUND AND nanobind_FOUND)
    set(TANDEM_BUILDS_PYTHON ON)
  else()
    message(STATUS "no nanobind or no Python headers: tandem.Collider is not built (scripts/setup fetches both)")
  endif()
endif()
