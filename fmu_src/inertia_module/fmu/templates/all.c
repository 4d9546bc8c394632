/* {{ model.title }}: kernel, tables and shell in one file. */
#define ALL_IN_ONE

/* of several files, each of which is free of them */
#if defined __GNUC__
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

{% for name in files %}
#include "{{ name }}"
{% endfor %}
