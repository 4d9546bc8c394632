/* The functions of the empty FMU that no benchmark calls, for hosts that look for all of them. */
#define NOTHING(name) \
    int name(void);   \
    int name(void)    \
    {                 \
        return 0;     \
    }

NOTHING(fmi2GetTypesPlatform)
NOTHING(fmi2GetVersion)
NOTHING(fmi2SetDebugLogging)
NOTHING(fmi2Terminate)
NOTHING(fmi2GetInteger)
NOTHING(fmi2GetBoolean)
NOTHING(fmi2GetString)
NOTHING(fmi2SetBoolean)
NOTHING(fmi2SetString)
NOTHING(fmi2GetFMUstate)
NOTHING(fmi2SetFMUstate)
NOTHING(fmi2FreeFMUstate)
NOTHING(fmi2SerializedFMUstateSize)
NOTHING(fmi2SerializeFMUstate)
NOTHING(fmi2DeSerializeFMUstate)
NOTHING(fmi2GetDirectionalDerivative)
NOTHING(fmi2SetRealInputDerivatives)
NOTHING(fmi2GetRealOutputDerivatives)
NOTHING(fmi2CancelStep)
NOTHING(fmi2GetStatus)
NOTHING(fmi2GetRealStatus)
NOTHING(fmi2GetIntegerStatus)
NOTHING(fmi2GetBooleanStatus)
NOTHING(fmi2GetStringStatus)
