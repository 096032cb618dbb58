# Modules that are loaded at run time (lib/modules): where they are installed, and where they are built.
set(INNERMAP_MODULES_FOLDER ${CMAKE_INSTALL_LIBDIR}/innermap)
set(INNERMAP_MODULES_BUILD_FOLDER ${PROJECT_BINARY_DIR}/lib/modules)

# Compile options of our own targets; nothing is set globally.
function(innermap_own_target target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  # Executables are compiled like libraries, so that all share the precompiled headers.
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE OFF
                        BUILD_RPATH ${INNERMAP_MODULES_BUILD_FOLDER})
  get_target_property(type ${target} TYPE)
  if(INNERMAP_BUILD_PICTURES AND type MATCHES "EXECUTABLE|MODULE" AND NOT target MATCHES "innermap_images")
    add_dependencies(${target} innermap_images)
  endif()
  target_compile_options(${target} PRIVATE -fPIC)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow)
  if(INNERMAP_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(INNERMAP_SANITIZE)
    # A finding of the undefined-behaviour sanitizer traps; the address sanitizer says where
    # (ASAN_OPTIONS=handle_sigill=1). Code that words each finding takes twice as long to compile.
    target_compile_options(${target} PRIVATE -fsanitize=${INNERMAP_SANITIZE}
      -fsanitize-undefined-trap-on-error -fno-omit-frame-pointer)
    if(INNERMAP_SANITIZE MATCHES "address.*undefined")
      # Checks at each access to memory, where the address sanitizer stops too, dear to compile.
      target_compile_options(${target} PRIVATE -fno-sanitize=null,object-size,pointer-overflow)
    endif()
    if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
      target_compile_options(${target} PRIVATE
        -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/sanitize_ignore.txt)
    endif()
    target_link_options(${target} PRIVATE -fsanitize=${INNERMAP_SANITIZE})
  endif()
endfunction()
