# The target `device`: compiles all kernels for a GPU, without a warning, and prints the registers and spills of each. `device_ptx` does not
# optimise and stops before registers are given away, a tenth of the time. Neither is part of `all`: nothing else needs them.
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
  foreach(target device device_ptx)
    add_custom_target(${target} COMMAND ${CMAKE_COMMAND} -E echo "${skipped}: the device build is skipped")
  endforeach()
  return()
endif()

set(report ${CMAKE_CURRENT_SOURCE_DIR}/scripts/device_kernels.py)
set(folder ${CMAKE_BINARY_DIR}/device)
file(MAKE_DIRECTORY ${folder})
set(logs "")
set(objects "")
set(assemblies "")
# compile_device(NAME EXTENSION FLAGS...)
function(compile_device name extension)
  set(source ${CMAKE_CURRENT_SOURCE_DIR}/src/talus/backend/cuda/${name}.cu)
  set(output ${folder}/${name}.${extension})
  # -fmad=false: products and sums are rounded one by one as on the host (-ffp-contract=off), so that results can be
  # compared.
  add_custom_command(OUTPUT ${output}
    COMMAND ${report} ${output}.log -- ${TALUS_NVCC} -ccbin ${CMAKE_CXX_COMPILER} -std=c++20 -arch=sm_90
      --expt-relaxed-constexpr -fmad=false -Werror all-warnings ${ARGN} -I${CMAKE_CURRENT_SOURCE_DIR}/src
      -MD -MT ${output} -MF ${output}.d ${source} -o ${output}
    DEPENDS ${source} ${report}
    DEPFILE ${output}.d
    BYPRODUCTS ${output}.log
    COMMENT "Compiling ${name} for a device"
    VERBATIM)
endfunction()
# nvcc has one thread for most of what it does, so several files take less time than one.
foreach(name kernels_of_laws kernels_of_stresses kernels_of_steps)
  compile_device(${name} o -Xptxas -v --split-compile=0 -c)
  compile_device(${name} ptx -G -ptx)
  list(APPEND logs ${folder}/${name}.o.log)
  list(APPEND objects ${folder}/${name}.o)
  list(APPEND assemblies ${folder}/${name}.ptx)
endforeach()
add_custom_target(device COMMAND ${report} ${logs} DEPENDS ${objects} VERBATIM)
add_custom_target(device_ptx DEPENDS ${assemblies})
