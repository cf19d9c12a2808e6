!> A script for gnuplot (--plot) that draws the table of a set: positions, velocities and accelerations over time and
!> over each drive, lengths beside angles. A picture shows some links, points or pairs, the next one those that follow.
module plot_script
   use kinds, only: wp
   use planar, only: in_degrees
   use mechanism, only: mechanism_t, instant_count
   use scales, only: characteristic_length, characteristic_rate, is_length
   use names, only: drive_name
   use csv, only: table_t
   use text_output, only: output_t, put, add, replaced
   use numerals, only: whole, full
   use phrases
   implicit none
   private
   public :: put_script

   !> Links, points and pairs in a picture: as many colours as can be told apart. Pictures: for as many in all as the
   !> picture of the mechanism has curves.
   integer, parameter :: page_rows = 5, max_pages = 12
   !> Colours that colour-blind readers can tell apart (Okabe and Ito 2002).
   character(7), parameter :: colors(page_rows) = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00']
   !> The least half height of a panel in parts of the characteristic length, angle or rate: what rounding changes in a
   !> quantity that is constant must not look like motion, nor make long numbers on the axis.
   real(wp), parameter :: least_height = 1.0e-3_wp
   !> Up to so many instants are marked by points.
   integer, parameter :: max_marked = 60

   !> What the panels show, by derivative.
   type(phrase_t), parameter :: length_words(0:2) = [say_position, say_velocity, say_acceleration], &
      angle_words(0:2) = [say_angle, say_angular_velocity, say_angular_acceleration]

contains

   !> Writes the script. `table`: the columns of the table of `m`; `suffix`: what the names of the files of this set
   !> have before their extension.
   subroutine put_script(o, m, table, suffix)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(table_t), intent(in) :: table
      character(*), intent(in) :: suffix
      character(:), allocatable :: ending
      logical :: own(size(table%columns), 2)      ! (columns, lengths or angles)
      integer :: rows, pages, page, i, k, n

      rows = maxval([0, table%columns%row])
      pages = min(max_pages, (rows + page_rows - 1)/page_rows)
      ! A script finds the table beside itself, wherever gnuplot is started.
      call put(o, '# gnuplot plot'//suffix//'.gp draws table'//suffix//'.csv: over time in time'//suffix &
         //'.svg and more, over the drives in drive'//suffix//'.svg and more')
      call put(o, 'here = ARG0')
      call put(o, 'while (here ne "" && here[strlen(here):] ne "/") { here = here[1:strlen(here) - 1] }')
      call put(o, 'table = here."table'//suffix//'.csv"')
      call put(o, 'set datafile separator ","')
      call put(o, '# The column on the abscissa: its picture and its name.')
      call put(o, &
         'picture(c) = here.(c == 1 ? "time" : c == 2 ? "drive" : sprintf("drive%d", c - 1))."'//suffix//'"')
      call add(o, 'abscissa(c) = c == 1 ? '//quoted('T ['//trim(m%time_unit)//']'))
      do i = 1, size(m%drives)
         call add(o, ' : c == '//whole(i + 1)//' ? '//quoted(trim(drive_name(m, m%drives(i)))//' [' &
            //unit_of(.not. is_length(m%drives(i)), 0)//']'))
      end do
      call put(o, ' : ""')
      call put(o, 'set terminal svg size 1200,1200 noenhanced background rgb "white"')
      call put(o, 'set style data '//trim(merge('linespoints', 'lines      ', instant_count(m) <= max_marked)))
      do i = 1, page_rows
         call put(o, 'set linetype '//whole(i)//' linecolor rgb "'//colors(i) &
            //'" linewidth 1.5 pointtype 7 pointsize 0.3')
      end do
      call put(o, 'set key above maxcols 4 samplen 2')
      call put(o, 'set grid linecolor rgb "#dddddd"')
      call put(o, 'set autoscale xfix')
      call put(o, 'set lmargin 14')
      call put(o, 'set rmargin 3')

      call put(o, 'do for [over = 1:'//whole(1 + size(m%drives))//'] {')
      ! A picture of the next links, points and pairs: lengths beside angles, derivatives below.
      do page = 1, pages
         own(:, 1) = table%columns%row > (page - 1)*page_rows .and. table%columns%row <= page*page_rows
         own(:, 2) = own(:, 1) .and. table%columns%angular
         own(:, 1) = own(:, 1) .and. .not. table%columns%angular
         ending = '.svg"'
         if (page > 1) ending = '-page'//whole(page)//ending
         call put(o, '   set output picture(over)."'//ending)
         call put(o, '   set multiplot layout 3,'//whole(count(any(own, dim=1)))//' title '//quoted(trim(m%title)) &
            //' font ",16"')
         do k = 0, 2
            call put(o, trim(merge('   set xlabel abscissa(over)', '   unset xlabel             ', k == 2)))
            do i = 1, 2
               if (any(own(:, i))) call put_panel( &
                  pack([(n, n=1, size(own, 1))], own(:, i) .and. table%columns%order == k), k, i == 2)
            end do
         end do
         call put(o, '   unset multiplot')
      end do
      call put(o, '}')
      if (rows > pages*page_rows) call put(o, '# The other columns of the table, from ' &
         //whole(2 + size(m%drives))//' on, are drawn in the same way.')

   contains

      !> The panel of the columns `list`, which are, or are not, `angular`: derivatives of order `k`. It is left empty
      !> where none of them has a value.
      subroutine put_panel(list, k, angular)
         integer, intent(in) :: list(:), k
         logical, intent(in) :: angular
         real(wp) :: length, margin
         integer :: i, before

         before = 1 + size(table%drives)
         call put(o, '   set ylabel '//quoted(phrase(merge(angle_words(k), length_words(k), angular), m%polish) &
            //' ['//unit_of(angular, k)//']'))
         call put(o, '   records = 0')
         call add(o, '   do for [c in "')
         do i = 1, size(list)
            call add(o, ' '//whole(before + list(i)))
         end do
         call put(o, '"] { if (records == 0) { stats table skip 1 using (column(int(c))) name "one" nooutput')
         call put(o, '      if (exists("one_records")) { records = one_records } } }')
         call put(o, '   if (records == 0) { set multiplot next } else {')
         call add(o, '      plot')
         do i = 1, size(list)
            associate (column => table%columns(list(i)))
               call put(o, ' table skip 1 using (column(over)):(column('//whole(before + list(i))//')) title ' &
                  //quoted(trim(column%name))//' linetype '//whole(1 + mod(column%row - 1, page_rows))//' dashtype ' &
                  //whole(merge(2, 1, column%coordinate == 2))//', \')
            end associate
            call add(o, '          ')
         end do
         ! How far it reaches beyond the first value of its first column, at least: in the units of the deck.
         length = characteristic_length(m)
         margin = least_height*characteristic_rate(m, length)**k
         if (.not. angular) margin = margin*length
         if (angular .and. m%degrees) margin = in_degrees(margin)
         call put(o, ' for [side = -1:1:2] table skip 1 every ::0::0 using (column(over)):(column(' &
            //whole(before + list(1))//') + side*'//full(margin)//') with lines linetype nodraw notitle')
         call put(o, '   }')
      end subroutine put_panel

      !> The unit of a length or an angle, or of its derivative of order `k`.
      pure function unit_of(angular, k) result(unit)
         logical, intent(in) :: angular
         integer, intent(in) :: k
         character(:), allocatable :: unit

         unit = trim(m%length_unit)
         if (angular) unit = merge('DEG', 'RAD', m%degrees)
         if (k == 1) unit = unit//'/'//trim(m%time_unit)
         if (k == 2) unit = unit//'/'//trim(m%time_unit)//'**2'
      end function unit_of
   end subroutine put_script

   !> `text` as gnuplot takes it, the characters that mean something there by their octal numbers. Reason: in a block a
   !> string between apostrophes cannot begin with one, and between quotation marks backquotes start a command.
   pure function quoted(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word

      word = '"'//replaced(text, '"\`', ['\042', '\134', '\140'])//'"'
   end function quoted
end module plot_script
