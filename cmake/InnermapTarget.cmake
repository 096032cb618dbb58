set(CMAKE_UNITY_BUILD_BATCH_SIZE 8 CACHE STRING "Sources that are compiled together at most, with CMAKE_UNITY_BUILD")

# Modules that are loaded at run time (lib/modules): where they are installed, and where they are built.
set(INNERMAP_MODULES_FOLDER ${CMAKE_INSTALL_LIBDIR}/innermap)
set(INNERMAP_MODULES_BUILD_FOLDER ${PROJECT_BINARY_DIR}/lib/modules)

# With CMAKE_UNITY_BUILD, sources of one folder are compiled together, CMAKE_UNITY_BUILD_BATCH_SIZE at most:
# what they include and instantiate alike is compiled once, for about half the processor time. So names
# in the unnamed namespaces of a folder's sources differ. SKIP_UNITY_BUILD_INCLUSION leaves a source out.
function(innermap_compile_together target)
  get_target_property(together ${target} UNITY_BUILD)
  get_target_property(sources ${target} SOURCES)
  if(NOT together OR NOT sources)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  # A class may have members of types that only its own source knows.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  set(folders "")
  foreach(source IN LISTS sources)
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    string(MAKE_C_IDENTIFIER "${folder}" folder)
    list(APPEND folders ${folder})
    list(APPEND in_${folder} ${source})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder IN LISTS folders)
    list(LENGTH in_${folder} count)
    math(EXPR batches "(${count} + ${CMAKE_UNITY_BUILD_BATCH_SIZE} - 1) / ${CMAKE_UNITY_BUILD_BATCH_SIZE}")
    set(number 0)
    foreach(source IN LISTS in_${folder})
      math(EXPR batch "${number} * ${batches} / ${count}")
      set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${folder}_${batch})
      math(EXPR number "${number} + 1")
    endforeach()
  endforeach()
endfunction()

# Compile options of our own targets; nothing is set globally.
function(innermap_own_target target)
  innermap_compile_together(${target})
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
