# The target `device`: compiles all kernels for a GPU, without a warning, and prints the registers and spills of each.
# It is no part of `all`: it takes a minute and nothing else needs it.
find_program(TALUS_NVCC nvcc HINTS ENV CUDA_PATH /usr/local/cuda PATH_SUFFIXES bin DOC "CUDA compiler of the target `device`")
set(skipped "")
if(NOT TALUS_NVCC)
  set(skipped "nvcc not found")
else()
  execute_process(COMMAND ${TALUS_NVCC} --version OUTPUT_VARIABLE version)
  string(REGEX MATCH "release ([0-9.]+)" version "${version}")
  if(CMAKE_MATCH_1 VERSION_LESS 12)
    set(skipped "nvcc ${CMAKE_MATCH_1} has no C++20; version 12 has")
  endif()
endif()
if(skipped)
  add_custom_target(device COMMAND ${CMAKE_COMMAND} -E echo "${skipped}: the device build is skipped")
  return()
endif()

set(report ${CMAKE_CURRENT_SOURCE_DIR}/scripts/device_kernels.py)
set(folder ${CMAKE_BINARY_DIR}/device)
file(MAKE_DIRECTORY ${folder})
set(logs "")
set(objects "")
# nvcc has one thread for most of what it does, so several files take less time than one.
foreach(name kernels_of_laws kernels_of_stresses kernels_of_steps)
  set(source ${CMAKE_CURRENT_SOURCE_DIR}/src/talus/backend/cuda/${name}.cu)
  # -fmad=false: products and sums are rounded one by one as on the host (-ffp-contract=off), so that results can be
  # compared.
  add_custom_command(OUTPUT ${folder}/${name}.o
    COMMAND ${report} ${folder}/${name}.log -- ${TALUS_NVCC} -ccbin ${CMAKE_CXX_COMPILER} -std=c++20 -arch=sm_90
      --expt-relaxed-constexpr -fmad=false -Werror all-warnings -Xptxas -v --split-compile=0
      -I${CMAKE_CURRENT_SOURCE_DIR}/src -MD -MT ${folder}/${name}.o -MF ${folder}/${name}.d -c ${source}
      -o ${folder}/${name}.o
    DEPENDS ${source} ${report}
    DEPFILE ${folder}/${name}.d
    BYPRODUCTS ${folder}/${name}.log
    COMMENT "Compiling ${name} for a device"
    VERBATIM)
  list(APPEND logs ${folder}/${name}.log)
  list(APPEND objects ${folder}/${name}.o)
endforeach()
add_custom_target(device COMMAND ${report} ${logs} DEPENDS ${objects} VERBATIM)
