from .agent_base import AgentBase as AgentBase
