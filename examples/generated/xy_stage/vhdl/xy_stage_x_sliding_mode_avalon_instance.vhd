-- An instance of xy_stage_x_sliding_mode_avalon, to copy into a design
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;
use work.xy_stage_x_sliding_mode_avalon_pkg.all;

entity xy_stage_x_sliding_mode_avalon_instance is
    port (
        clk                    : in  std_logic;
        rst                    : in  std_logic;
        avs_address            : in  std_logic_vector(7 downto 0);
        avs_read               : in  std_logic;
        avs_write              : in  std_logic;
        avs_byteenable         : in  std_logic_vector(3 downto 0);
        avs_writedata          : in  std_logic_vector(31 downto 0);
        start                  : in  std_logic;
        position_reference     : in  std_logic_vector(31 downto 0);  -- signed
        velocity_reference     : in  std_logic_vector(31 downto 0);  -- signed
        acceleration_reference : in  std_logic_vector(31 downto 0);  -- signed
        position               : in  std_logic_vector(31 downto 0);  -- signed
        velocity               : in  std_logic_vector(31 downto 0);  -- signed
        avs_readdata           : out std_logic_vector(31 downto 0);
        irq                    : out std_logic;
        command                : out std_logic_vector(31 downto 0);  -- signed
        duty                   : out std_logic_vector(17 downto 0);  -- signed
        valid                  : out std_logic
    );
end entity;

architecture template of xy_stage_x_sliding_mode_avalon_instance is
begin
    u_xy_stage_x_sliding_mode_avalon : xy_stage_x_sliding_mode_avalon
        port map (
            clk                    => clk,
            rst                    => rst,
            avs_address            => avs_address,
            avs_read               => avs_read,
            avs_write              => avs_write,
            avs_byteenable         => avs_byteenable,
            avs_writedata          => avs_writedata,
            start                  => start,
            position_reference     => position_reference,
            velocity_reference     => velocity_reference,
            acceleration_reference => acceleration_reference,
            position               => position,
            velocity               => velocity,
            avs_readdata           => avs_readdata,
            irq                    => irq,
            command                => command,
            duty                   => duty,
            valid                  => valid
        );
end architecture;
