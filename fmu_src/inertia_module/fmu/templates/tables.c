/* Tables of {{ model.name }}, made from its table of variables. */
#include "model.h"

#include <math.h>

static const struct variable variables[] = {
{% for variable in rows %}
{% if variable is none %}{# a value reference that no variable has #}
    {"", UNUSED, CLOCK, 0, -1, -1, -1, 0, 0, 0, 0.0, 0.0, 0.0, 1.0, ""},
{% elif variable == model.time %}{# no place in a record of the kernel, no rate #}
    {"time", REAL, CLOCK, 0, -1, -1, -1, 0, 0, 0, 0.0, -HUGE_VAL, HUGE_VAL, 1.0, ""},
{% else %}
    {{ "{" }}{{ quoted(variable.name) }}, {{ variable.kind | upper }}, {{ arrays.get(variable.causality, "OUTPUTS") }}, {{ model.place(variable.name) }},
{% for ending in ("_rate", "_has_rate") %}
     {{ model.place(variable.name ~ ending) if variable.causality == "input" else -1 }},
{% endfor %}
     {{ discrete.index(variable.name) if variable.name in discrete else -1 }}, {{ variable.late | int }}, {{ (variable.causality == "output") | int }}, {{ variable.is_tunable | int }},
     {{ number(variable.start or 0.0) }}, {{ number(variable.ends[0]) }}, {{ number(variable.ends[1]) }}, {{ number(small(variable)) }},
     {{ quoted(variable.allowed if variable.causality == "parameter" else "") }}},
{% endif %}
{% endfor %}
};

{% for name, texts in (("messages", model.messages), ("warnings", model.warnings)) if texts %}
{% for status, text in texts.items() %}
static const struct piece {{ name }}_{{ status }}[] = {
{% for before, kind, slot in pieces(text, model) %}
    {{ "{" }}{{ quoted(before) }}, {{ kind }}, {{ slot }}},
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
static const int discrete[] = {
{% for name in discrete %}
    {{ model.place(name) }},
{% else %}{# C has no empty arrays #}
    0,
{% endfor %}
};
static const size_t traced[] = {{ "{%s}" | format(traced | join(", ")) }};

static const struct bound bounds[] = {
{% for bound in model.bounds %}
    {{ "{%s, %d, %s}" | format(records[bound.record], bound.place, number(bound.maximum)) }},
{% else %}
    {CONSTANTS, 0, 0.0},
{% endfor %}
};

INTERNAL_OBJECT const struct model model = {
    {{ quoted(model.name) }}, {{ quoted(guid) }}, variables, {{ rows | length }},
    {{ tolerance }}, {{ switch | join(", ") }},
    {{ model.sizes | join(", ") }},
    messages, {{ model.messages | length }}, {{ "warnings" if model.warnings else "NULL" }}, {{ model.warnings | length }},
    discrete, {{ discrete | length }}, traced, {{ traced | length }}, bounds, {{ model.bounds | length }},
};
