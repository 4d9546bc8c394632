/* Tables of {{ model.name }}, made from its table of variables. */
#include "model.h"

#include <math.h>

static const struct variable variables[] = {
{% for variable in model.variables %}
    {{ row(variable, model) }},
{% endfor %}
{% if fmi == 3 %}{# no place in a record of the kernel, no rate #}
    {"time", REAL, CLOCK, 0, -1, -1, -1, 0, 0, 0, 0.0, -HUGE_VAL, HUGE_VAL, 1.0, ""},
{% endif %}
};

{% for name, texts in (("messages", model.messages), ("warnings", model.warnings)) if texts %}
{% for status, text in texts.items() %}
static const struct piece {{ name }}_{{ status }}[] = {
{% for piece in pieces(text, model) %}
    {{ piece }},
{% endfor %}
    {"", LAST_PIECE, 0},
};

{% endfor %}
static const struct message {{ name }}[] = {
{% for status in texts %}
    {{ "{%d, %s_%d}" | format(status, name, status) }},
{% endfor %}
};

{% endfor %}
static const int discrete[] = {{ "{%s}" | format(discrete | join(", ") or "0") }};
static const size_t traced[] = {{ "{%s}" | format(traced | join(", ")) }};

static const struct bound bounds[] = {
{% for one in bounds or [none] %}{# C has no empty arrays #}
    {{ "{%s, %d, %s}" | format(records[one.record], one.place, number(one.most)) if one else "{CONSTANTS, 0, 0.0}" }},
{% endfor %}
};

const struct model model = {
    {{ quoted(model.name) }}, {{ quoted(guid) }}, variables, {{ model.variables | length + fmi - 2 }},
    {{ tolerance }}, {{ switch | join(", ") }},
    {{ model.sizes | join(", ") }},
    messages, {{ model.messages | length }}, {{ "warnings" if model.warnings else "NULL" }}, {{ model.warnings | length }},
    discrete, {{ discrete | length }}, traced, {{ traced | length }}, bounds, {{ bounds | length }},
};
