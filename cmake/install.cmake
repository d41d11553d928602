# What `cmake --install` installs, and Debian packages of it (`./dev deb`). Instrumented code is not installed.
#
#   bin/talus                        the program
#   lib/talus/                       its libraries, for talus only: no stable interface. glibc-hwcaps/ below has the kernels for newer processors
#   lib/libtalus_law.so.0            the laws for other programs (include/talus/law.h); versioned, bindings/c/exports.map has its symbols
#   lib/libtalus_umat.so             user material of Abaqus, PLAXIS and Anura3D, loaded at run time
#   lib/talus/libtalus_mpi.so        with TALUS_MPI: runs over several processes
#   include/talus/, lib/cmake/talus  header and configuration for find_package(talus)
if(TALUS_SANITIZE)
  return()
endif()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(own_libraries ${CMAKE_INSTALL_LIBDIR}/talus)
file(RELATIVE_PATH from_program ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/talus)

# Libraries are found from where talus is; without /proc, as in a bare root, the loader knows no such place, and the second path serves.
set(packaged_libraries /usr/${CMAKE_INSTALL_LIBDIR}/talus)
install(TARGETS talus RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
set_target_properties(talus PROPERTIES INSTALL_RPATH "$ORIGIN/${from_program};${packaged_libraries}")
install(TARGETS libtalus libtalus_kernels LIBRARY DESTINATION ${own_libraries} COMPONENT program)
set_target_properties(libtalus libtalus_kernels PROPERTIES INSTALL_RPATH "$ORIGIN;${packaged_libraries}")
if(build_for_all)
  foreach(level 3 4)
    install(TARGETS libtalus_kernels_v${level} LIBRARY DESTINATION ${own_libraries}/glibc-hwcaps/x86-64-v${level} COMPONENT program)
    set_target_properties(libtalus_kernels_v${level} PROPERTIES INSTALL_RPATH "$ORIGIN/../..;${packaged_libraries}")
  endforeach()
endif()

install(TARGETS talus_law LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT program NAMELINK_COMPONENT development)
install(TARGETS talus_umat LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT program)
set_target_properties(talus_law talus_umat PROPERTIES INSTALL_RPATH "$ORIGIN/talus;${packaged_libraries}")
if(TALUS_MPI)
  install(TARGETS libtalus_mpi LIBRARY DESTINATION ${own_libraries} COMPONENT mpi)
endif()

install(DIRECTORY include/talus DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/talus)
configure_package_config_file(cmake/talusConfig.cmake.in ${CMAKE_BINARY_DIR}/talusConfig.cmake INSTALL_DESTINATION ${config_folder}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/talusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/talusConfig.cmake ${CMAKE_BINARY_DIR}/talusConfigVersion.cmake DESTINATION ${config_folder} COMPONENT development)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT program)
install(DIRECTORY cases DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

# Debian packages: a component of the installation each. Another one needs its name in `packaged`, and its package below.
set(packaged program development)
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_PACKAGE_VENDOR talus)
set(CPACK_PACKAGE_CONTACT "talus developers <talus@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME talus)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Granular ground that fails, flows and comes to rest
 Solver for granular flow: a unified elastoplastic and mu(I) law in a material
 point method, in two and three dimensions. With the libraries of its laws for
 other programs: C interface, user materials of Abaqus, PLAXIS and Anura3D.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtalus-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Laws of talus for other programs (development files)
 Header of the C interface and configuration for CMake.")
set(CPACK_COMPONENT_DEVELOPMENT_DEPENDS program)
if(TALUS_PYTHON)
  list(APPEND packaged python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-talus)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, python3-h5py")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "talus as a Python module")
  set(CPACK_COMPONENT_PYTHON_DEPENDS program)
endif()
if(TALUS_MPI)
  list(APPEND packaged mpi)
  set(CPACK_DEBIAN_MPI_PACKAGE_NAME talus-mpi)
  set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS openmpi-bin)
  set(CPACK_COMPONENT_MPI_DESCRIPTION "Runs of talus over several processes
 Messages between processes by Open MPI: mpirun -n 4 talus run CASE.toml.")
  set(CPACK_COMPONENT_MPI_DEPENDS program)
endif()
set(CPACK_COMPONENTS_ALL ${packaged})
include(CPack)
