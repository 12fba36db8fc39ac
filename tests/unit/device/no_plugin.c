/* A shared library that is no plug-in. */
int argil_no_plugin(void);
int argil_no_plugin(void) {
  return 0;
}
