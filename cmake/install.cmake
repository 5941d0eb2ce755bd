# SPDX-License-Identifier: MIT
# Installs the library, its public headers and a CMake package: find_package(tandem), tandem::tandem.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Users include <tandem/backends/device.h>. The headers include each other relative to the tree's root.
target_include_directories(tandem INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
install(TARGETS tandem EXPORT tandem-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TANDEM_HAS_MPI)
  install(TARGETS tandem-mpi EXPORT tandem-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
install(TARGETS tandem-cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES scripts/completion/tandem.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME tandem)
install(FILES scripts/completion/_tandem DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
# Programs that convert records and draw exports, with the project's name as prefix. cmake/external.cmake installs those of the
# Python package.
foreach(script render convert_records)
  string(REPLACE _ - name tandem-${script})
  install(PROGRAMS scripts/${script} DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME ${name})
endforeach()
set(public_headers
  backends/device.h backends/handles.h backends/trace.h backends/registry.h backends/backend_report.h backends/driver_report.h backends/host/host_device.h backends/opencl/opencl_device.h
  backends/cuda/cuda_device.h backends/ranks.h
  algorithms/traversal.h algorithms/bodies/device_frame.h algorithms/bodies/body_pair.h algorithms/bodies/frame_input.h algorithms/kernels/counter.h algorithms/bodies/cost.h algorithms/answer/frame_result.h algorithms/answer/queued_frame.h algorithms/answer/queued.clh
  algorithms/parameters/parameter.h algorithms/parameters/choices.h algorithms/parameters/contact_rules.clh
  algorithms/parameters/table.h
  algorithms/bounds/geometry.h algorithms/bodies/range.h algorithms/bodies/check_input.h scenes/scene.h scenes/dynamics.h
  scenes/contact.h scenes/simulate/simulation.h scenes/mesh.h scenes/mesh_reading.h scenes/builtin.h base/error.h)
if(TANDEM_HAS_MPI)
  list(APPEND public_headers backends/mpi/mpi_ranks.h)
endif()
foreach(header ${public_headers})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tandem/${folder})
endforeach()
install(FILES cmake/tandem.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tandem)
install(FILES LICENSE NOTICE.md README.md CHANGELOG.md CITATION.cff CITATION.bib DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(EXPORT tandem-targets NAMESPACE tandem:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tandem)
set(embree_dependency)
set(embree_library)
if(TANDEM_HAS_MPI)
  set(mpi_dependency "find_dependency(MPI COMPONENTS CXX)\n")
endif()
if(embree_FOUND)
  set(embree_dependency "find_dependency(embree ${embree_VERSION_MAJOR})\n")
  set(embree_library " -lembree${embree_VERSION_MAJOR}")
endif()
file(WRITE ${PROJECT_BINARY_DIR}/tandem-config.cmake "include(CMakeFindDependencyMacro)
list(APPEND CMAKE_MODULE_PATH \${CMAKE_CURRENT_LIST_DIR})
foreach(package Eigen3 fmt nlohmann_json OpenCL ZLIB LibLZMA LZ4 Threads TBB GMP)
  find_dependency(\${package})
endforeach()
${embree_dependency}${mpi_dependency}include(\${CMAKE_CURRENT_LIST_DIR}/tandem-targets.cmake)
if(TARGET tandem::mpi)
  set(tandem_mpi_FOUND TRUE)
endif()
foreach(component \${tandem_FIND_COMPONENTS})
  if(tandem_FIND_REQUIRED_\${component} AND NOT tandem_\${component}_FOUND)
    set(tandem_FOUND FALSE)
    set(tandem_NOT_FOUND_MESSAGE \"this tandem has no component \${component}; mpi is the only one, of builds with MPI\")
  endif()
endforeach()
")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/tandem-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/tandem-config.cmake ${PROJECT_BINARY_DIR}/tandem-config-version.cmake
              cmake/FindGMP.cmake cmake/FindLZ4.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tandem)

# pkg-config's file names the libraries of a static link. cmake --install --prefix changes the folder, so that it is configured then.
install(CODE "set(embree_library \"${embree_library}\")
set(PROJECT_VERSION ${PROJECT_VERSION})
set(CMAKE_INSTALL_LIBDIR ${CMAKE_INSTALL_LIBDIR})
set(CMAKE_INSTALL_INCLUDEDIR ${CMAKE_INSTALL_INCLUDEDIR})
configure_file(${PROJECT_SOURCE_DIR}/cmake/tandem.pc.in ${PROJECT_BINARY_DIR}/tandem.pc @ONLY)
file(INSTALL ${PROJECT_BINARY_DIR}/tandem.pc DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/pkgconfig\")")
