# SPDX-License-Identifier: MIT
# NVIDIA's cuBQL, a baseline on CUDA: needs its headers (-DCUBQL_INCLUDE_DIR=<clone of github.com/NVIDIA/cuBQL>) and CUDA's
# compiler. Only its own files are compiled by nvcc, so that a program without it needs no CUDA.
find_path(CUBQL_INCLUDE_DIR cuBQL/bvh.h)
set(CUBQL_FOUND FALSE)
if(CUBQL_INCLUDE_DIR)
  find_package(CUDAToolkit QUIET)
  if(CUDAToolkit_NVCC_EXECUTABLE AND TARGET CUDA::cudart_static)
    set(CUBQL_FOUND TRUE)
  else()
    message(STATUS "cuBQL's headers, but no CUDA compiler and static runtime: algorithm cubql is not available")
  endif()
endif()

# tandem_cubql(TARGET FOLDER): compiles build.cu of FOLDER into TARGET, and query.cu to PTX that TARGET contains. Call
# it in the directory of the target.
function(tandem_cubql target folder)
  set(from ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/cubql)
  file(MAKE_DIRECTORY ${out})
  set(nvcc ${CUDAToolkit_NVCC_EXECUTABLE} -std=c++17 -O3 -arch=compute_80 --fmad=false -I${PROJECT_SOURCE_DIR}
      -isystem ${CUBQL_INCLUDE_DIR})
  add_custom_command(OUTPUT ${out}/build.o
    COMMAND ${nvcc} -Xcompiler -fPIC -c ${from}/build.cu -o ${out}/build.o
    DEPENDS ${from}/build.cu ${from}/build.h COMMENT "Compiling cuBQL's builder" VERBATIM)
  add_custom_command(OUTPUT ${out}/query.ptx
    COMMAND ${nvcc} -ptx ${from}/query.cu -o ${out}/query.ptx
    DEPENDS ${from}/query.cu ${from}/build.h ${PROJECT_SOURCE_DIR}/algorithms/kernels/status.clh COMMENT "Compiling queries of cuBQL" VERBATIM)
  file(CONFIGURE OUTPUT ${out}/query_ptx.cpp @ONLY CONTENT [=[
extern const char tandem_query_ptx[];
__asm__(".pushsection .rodata\ntandem_query_ptx: .incbin \"@out@/query.ptx\"\n.byte 0\n.popsection\n");
namespace tandem::cubql_trees {
extern const char* const query_ptx;
const char* const query_ptx = tandem_query_ptx;
} // namespace tandem::cubql_trees
]=])
  set_source_files_properties(${out}/query_ptx.cpp PROPERTIES OBJECT_DEPENDS ${out}/query.ptx)
  target_sources(${target} PRIVATE ${out}/query_ptx.cpp ${out}/build.o)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:CUDA::cudart_static>)
endfunction()
