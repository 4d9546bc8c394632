"""The independent reference: equations of motion of their own, integrated from event to event."""
