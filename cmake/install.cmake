# What `cmake --install` puts into a system, and the Debian package that CPack makes of it (setup/package.sh).
include(GNUInstallDirs)

# Completions and the manual come from the catalog, so the program writes them.
set(shell_files ${PROJECT_BINARY_DIR}/shell_files)
file(MAKE_DIRECTORY ${shell_files})
set(made)
function(formwright_writes file)
  add_custom_command(OUTPUT ${shell_files}/${file} COMMAND formwright ${ARGN} > ${shell_files}/${file} DEPENDS formwright VERBATIM)
  set(made ${made} ${shell_files}/${file} PARENT_SCOPE)
endfunction()
formwright_writes(formwright.bash completions bash)
formwright_writes(_formwright completions zsh)
formwright_writes(formwright.fish completions fish)
formwright_writes(formwright.1 manual)
add_custom_target(shell_files ALL DEPENDS ${made})
add_dependencies(app shell_files)

# Folders below the prefix; a person's own prefix has the same ones.
install(TARGETS formwright RUNTIME)
install(FILES ${shell_files}/formwright.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME formwright)
install(FILES ${shell_files}/_formwright DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${shell_files}/formwright.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES ${shell_files}/formwright.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
# The service names the program by its full path, which only the installation knows.
install(CODE "
  set(program \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/formwright\")
  configure_file(\"${CMAKE_CURRENT_LIST_DIR}/formwright.service\"
    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/lib/systemd/user/formwright.service\" @ONLY)")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
set(page ${PROJECT_SOURCE_DIR}/web/dist)
install(CODE "
  if(NOT EXISTS \"${page}/index.html\")
    message(FATAL_ERROR \"The page is not built: run `setup/build.sh wasm-app web` first.\")
  endif()")
install(DIRECTORY ${page}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/formwright/web)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME formwright)
set(CPACK_PACKAGE_CONTACT "Formwright <formwright@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "from a 3D model to reliefs, thermoformed shells and zippables")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Computes reliefs, thermoformed shells with their prints and moulds, and zippables\nfrom 3D models, and jobs for lasers and mills: on the command line, or in a page\nthat this machine serves to its own browser.")
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # what the program links decides what the package needs
set(CPACK_STRIP_FILES ON)
include(CPack)
