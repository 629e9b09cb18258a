-- An instance of xy_stage_x_pulse_counter_avalon, to copy into a design
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;
use work.xy_stage_x_pulse_counter_avalon_pkg.all;

entity xy_stage_x_pulse_counter_avalon_instance is
    port (
        clk            : in  std_logic;
        rst            : in  std_logic;
        avs_address    : in  std_logic_vector(7 downto 0);
        avs_read       : in  std_logic;
        avs_write      : in  std_logic;
        avs_byteenable : in  std_logic_vector(3 downto 0);
        avs_writedata  : in  std_logic_vector(31 downto 0);
        a              : in  std_logic;
        b              : in  std_logic;
        z              : in  std_logic;
        a_n            : in  std_logic;
        b_n            : in  std_logic;
        z_n            : in  std_logic;
        avs_readdata   : out std_logic_vector(31 downto 0);
        irq            : out std_logic;
        tick           : out std_logic;
        position       : out std_logic_vector(31 downto 0);  -- signed
        velocity       : out std_logic_vector(31 downto 0);  -- signed
        velocity_valid : out std_logic
    );
end entity;

architecture template of xy_stage_x_pulse_counter_avalon_instance is
begin
    u_xy_stage_x_pulse_counter_avalon : xy_stage_x_pulse_counter_avalon
        port map (
            clk            => clk,
            rst            => rst,
            avs_address    => avs_address,
            avs_read       => avs_read,
            avs_write      => avs_write,
            avs_byteenable => avs_byteenable,
            avs_writedata  => avs_writedata,
            a              => a,
            b              => b,
            z              => z,
            a_n            => a_n,
            b_n            => b_n,
            z_n            => z_n,
            avs_readdata   => avs_readdata,
            irq            => irq,
            tick           => tick,
            position       => position,
            velocity       => velocity,
            velocity_valid => velocity_valid
        );
end architecture;
