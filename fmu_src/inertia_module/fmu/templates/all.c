/* {{ model.title }} in one file, which includes the others: compile this one alone. */
#define ALL_IN_ONE

/* each file is free of these by itself */
#if defined __GNUC__
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

{% for name in files %}
#include "{{ name }}"
{% endfor %}
