# SPDX-License-Identifier: MIT
set(TANDEM_LEVELS 2 3 4 CACHE STRING "Levels of x86-64 that host kernels with lanes are compiled for; native: the level of this processor")
set(TANDEM_HIGHER_K "" CACHE STRING "Values of k that host kernels of the levels above the lowest are compiled for; empty: all. Other values use the lowest level. Everything but kernels with lanes is then compiled with less optimisation")
set(TANDEM_HOST_K "" CACHE STRING "Values of k that host kernels are compiled for; empty: all. For a first build in less time")

# Sets `result` to the levels of TANDEM_LEVELS without duplicates, with `native` replaced by the level of this processor.
function(tandem_levels result)
  set(levels ${TANDEM_LEVELS})
  if(native IN_LIST levels)
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} -march=native -dM -E -x c++ /dev/null
                    OUTPUT_VARIABLE has COMMAND_ERROR_IS_FATAL ANY)
    set(native 2)
    if(has MATCHES "__AVX2__" AND has MATCHES "__FMA__" AND has MATCHES "__BMI2__")
      set(native 3)
    endif()
    if(native EQUAL 3 AND has MATCHES "__AVX512BW__" AND has MATCHES "__AVX512CD__" AND has MATCHES "__AVX512DQ__"
       AND has MATCHES "__AVX512VL__")
      set(native 4)
    endif()
    list(TRANSFORM levels REPLACE native ${native})
  endif()
  list(REMOVE_DUPLICATES levels)
  foreach(level ${levels})
    if(NOT level MATCHES "^[234]$")
      message(FATAL_ERROR "TANDEM_LEVELS=${TANDEM_LEVELS}: give a list of 2, 3, 4 and native")
    endif()
  endforeach()
  set(${result} ${levels} PARENT_SCOPE)
endfunction()

# tandem_kernels(TARGET K:AXES[:PRESSURE_SLAB]... [FOLDER F]): flattens each kernel file of algorithms/ with its headers and embeds the
# texts. It also compiles them for the host backend in every listed geometry, in both precisions, and generates a header
# with the arguments of its kernels for each file, "algorithms/tiled/tiled.cl.h". With FOLDER it takes
# the kernel files of that folder instead. They register themselves beside the library's at program start, where TARGET
# is a program or its objects. Call it in the directory of the target, because generated sources are known only there.
function(tandem_kernels target)
  cmake_parse_arguments(PARSE_ARGV 1 given "" "FOLDER" "")
  set(folder algorithms)
  set(out ${PROJECT_BINARY_DIR}/kernels/${target})
  set(own)
  if(given_FOLDER)
    set(folder ${given_FOLDER})
    set(own --own ${target})
  endif()
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed_kernels.py)
  set(scripts ${script} ${PROJECT_SOURCE_DIR}/cmake/kernel_arguments.py)
  file(GLOB_RECURSE kernels CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${folder}/*.cl)
  list(TRANSFORM kernels PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE files)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/backends/lanes.h ${PROJECT_SOURCE_DIR}/backends/packs.h ${PROJECT_SOURCE_DIR}/backends/portable.h
       ${PROJECT_SOURCE_DIR}/algorithms/*.clh ${PROJECT_SOURCE_DIR}/${folder}/*.clh)
  set(geometries)
  foreach(k_axes ${given_UNPARSED_ARGUMENTS})
    string(REPLACE ":" ";" pair ${k_axes}:0)
    list(GET pair 0 k)
    list(GET pair 1 axes)
    list(GET pair 2 pressure_slab)
    if(TANDEM_HOST_K AND NOT k IN_LIST TANDEM_HOST_K)
      continue()
    endif()
    math(EXPR ends "${k} + 2 * ${pressure_slab}")
    foreach(precision 32 64)
      list(APPEND geometries "AXES=${axes},K=${ends},PRECISION=${precision},PRESSURE_SLAB=${pressure_slab}")
    endforeach()
  endforeach()
  # Several geometries per file: reading the headers takes as long as compiling one geometry. Few geometries are spread over
  # the cores instead.
  list(LENGTH geometries count)
  set(generated ${out}/sources.cpp ${out}/host_table.cpp)
  set(each 4)
  if(count LESS_EQUAL each)
    set(each 1)
  endif()
  math(EXPR last "(${count} - 1) / ${each}")
  # Kernels with lanes are compiled for several levels of x86-64. The host device uses the highest that the processor
  # supports. For other processors and with sanitizers they are compiled with the options of all other files.
  set(levels)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT given_FOLDER AND NOT TANDEM_SANITIZE)
    tandem_levels(levels)
  endif()
  foreach(part RANGE ${last})
    list(APPEND generated ${out}/host_${part}.cpp)
    foreach(level ${levels})
      list(APPEND generated ${out}/host_v${level}_${part}.cpp)
      set(of_level_${level} ${of_level_${level}} ${out}/host_v${level}_${part}.cpp)
    endforeach()
  endforeach()
  list(TRANSFORM kernels PREPEND ${out}/ OUTPUT_VARIABLE argument_headers)
  list(TRANSFORM argument_headers APPEND .h)
  add_custom_command(OUTPUT ${generated} ${argument_headers}
    COMMAND ${Python3_EXECUTABLE} ${script} --root ${PROJECT_SOURCE_DIR} --out ${out} --geometries ${geometries}
            --each ${each} --levels ${levels} --higher-k ${TANDEM_HIGHER_K} --kernels ${kernels} ${own}
    DEPENDS ${scripts} ${files} ${headers} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Flattening kernels" VERBATIM)
  target_sources(${target} PRIVATE ${generated})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${out}>)
  # For targets that include the headers without linking with this one.
  add_custom_target(${target}-arguments DEPENDS ${argument_headers})
  add_dependencies(${target} ${target}-arguments)
  # g++ 12 takes the undefined operands of AVX-512 intrinsics for uninitialised variables (GCC bug 105593).
  set(options -Wno-psabi -Wno-maybe-uninitialized -Wno-uninitialized -Wno-unused-function -Wno-unused-variable -Wno-unused-parameter -Wno-unknown-pragmas -Wno-type-limits)
  if(TANDEM_QUICK_BUILD)
    list(APPEND options -O3)
  endif()
  if(TANDEM_SANITIZE)
    # With -fsanitize=bounds, g++ 12 reads uninitialised temporaries in certainty.clh: it reports them, and the decisions
    # differ from those of all other builds. Addresses are still checked.
    list(APPEND options -fno-sanitize=bounds)
  endif()
  set_source_files_properties(${generated} PROPERTIES COMPILE_OPTIONS "${options}" SKIP_PRECOMPILE_HEADERS ON)
  list(SORT levels)
  list(POP_FRONT levels lowest)
  foreach(level ${lowest} ${levels})
    # Files of a level must inline what all files define. In a build for tests -O3 is left to higher levels than the lowest.
    set(lanes)
    if(TANDEM_HIGHER_K AND levels AND level EQUAL lowest)
      set(lanes -finline-functions)
    elseif(TANDEM_HIGHER_K)
      set(lanes -O3)
    endif()
    set_source_files_properties(${of_level_${level}} PROPERTIES COMPILE_OPTIONS "${options};${lanes};-march=x86-64-v${level}"
                                SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
endfunction()
