#include "talus/app/templates.hpp"

#include <cstddef>

// The build writes TALUS_TEMPLATES, a line TALUS_TEMPLATE(name, "file") for each; the assembler includes the bytes.
#define TALUS_TEMPLATE(name, file)                                                                   \
  asm(".pushsection .rodata\ntalus_template_" #name ":\n.incbin \"" file "\"\ntalus_template_" #name \
      "_end:\n.popsection\n");                                                                       \
  extern "C" const char talus_template_##name[], talus_template_##name##_end[];
#include TALUS_TEMPLATES
#undef TALUS_TEMPLATE

namespace talus {

std::span<const Template> templates() {
#define TALUS_TEMPLATE(name, file) \
  {#name, {talus_template_##name, std::size_t(talus_template_##name##_end - talus_template_##name)}},
  static const Template all[] = {
#include TALUS_TEMPLATES
  };
  return all;
}

}  // namespace talus
