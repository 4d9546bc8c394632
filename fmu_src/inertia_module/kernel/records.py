"""Names of the kernel's records and tuples in annotations.

The fields are in kernel.fields and in the table of variables. From them compiling.stubs writes records.pyi,
by which mypy checks the kernel. In plain Python a record is made by interface.records.
"""

Doubles = list  # doubles in a row
Records = list  # records in a row
Position = tuple  # position of an imbalance and its first and second derivative in q
ReducedInertia = tuple  # I, B, G, each with its derivative in q
# Of the inertia module
Column = Constants = Integrated = Inputs = Machine = Mean = Beginning = Now = Outputs = Outputs0 = (
    Parameters
) = Side = State = Steady = Indicators = Workspace = object
# Of the driven shaft
ShaftConstants = ShaftInputs = ShaftOutputs = ShaftParameters = ShaftState = ShaftWorkspace = object
