-- An instance of xy_stage_y_shaper_avalon, to copy into a design
-- Written by posicast 0.1.0; do not edit.

library ieee;
use ieee.std_logic_1164.all;
use work.xy_stage_y_shaper_avalon_pkg.all;

entity xy_stage_y_shaper_avalon_instance is
    port (
        clk            : in  std_logic;
        rst            : in  std_logic;
        avs_address    : in  std_logic_vector(7 downto 0);
        avs_read       : in  std_logic;
        avs_write      : in  std_logic;
        avs_byteenable : in  std_logic_vector(3 downto 0);
        avs_writedata  : in  std_logic_vector(31 downto 0);
        strobe         : in  std_logic;
        start          : in  std_logic;
        x_0            : in  std_logic_vector(31 downto 0);  -- signed
        x_1            : in  std_logic_vector(31 downto 0);  -- signed
        x_2            : in  std_logic_vector(31 downto 0);  -- signed
        avs_readdata   : out std_logic_vector(31 downto 0);
        irq            : out std_logic;
        y_0            : out std_logic_vector(31 downto 0);  -- signed
        y_1            : out std_logic_vector(31 downto 0);  -- signed
        y_2            : out std_logic_vector(31 downto 0);  -- signed
        valid          : out std_logic
    );
end entity;

architecture template of xy_stage_y_shaper_avalon_instance is
begin
    u_xy_stage_y_shaper_avalon : xy_stage_y_shaper_avalon
        port map (
            clk            => clk,
            rst            => rst,
            avs_address    => avs_address,
            avs_read       => avs_read,
            avs_write      => avs_write,
            avs_byteenable => avs_byteenable,
            avs_writedata  => avs_writedata,
            strobe         => strobe,
            start          => start,
            x_0            => x_0,
            x_1            => x_1,
            x_2            => x_2,
            avs_readdata   => avs_readdata,
            irq            => irq,
            y_0            => y_0,
            y_1            => y_1,
            y_2            => y_2,
            valid          => valid
        );
end architecture;
