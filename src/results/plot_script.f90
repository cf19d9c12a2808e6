!> A script for gnuplot (--plot) that draws the table of a set: positions, velocities and accelerations over time and
!> over each drive, lengths beside angles. A picture shows some links, points or pairs, the next one those that follow.
module plot_script
   use kinds, only: wp
   use planar, only: in_degrees
   use mechanism, only: mechanism_t, instant_count
   use scales, only: characteristic_length, characteristic_rate
   use names, only: drive_name
   use table, only: table_t
   use text_output, only: output_t, put, add
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
      integer :: rows, pages, i

      rows = maxval([0, table%columns%row])
      pages = min(max_pages, (rows + page_rows - 1)/page_rows)
      call put_beginning()
      call put(o, 'do for [over = 1:'//whole(1 + size(m%drives))//'] {')
      do i = 1, pages
         call put_page(i)
      end do
      call put(o, '}')
      if (rows > pages*page_rows) call put(o, '# The other columns of the table, from ' &
         //whole(2 + size(m%drives))//' on, are drawn in the same way.')

   contains

      !> What holds for all pictures. A script finds the table beside itself, wherever gnuplot is started.
      subroutine put_beginning()
         integer :: i

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
               //unit_of(m, table%angular(i), 0)//']'))
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
      end subroutine put_beginning

      !> The picture of the `page`-th links, points and pairs over the column `over`.
      subroutine put_page(page)
         integer, intent(in) :: page
         character(:), allocatable :: ending
         logical :: is_there(2)
         integer :: k, i

         ending = ''
         if (page > 1) ending = '-page'//whole(page)
         associate (own => table%columns%row > (page - 1)*page_rows .and. table%columns%row <= page*page_rows)
            is_there = [any(own .and. .not. table%columns%angular), any(own .and. table%columns%angular)]
            call put(o, '   set output picture(over)."'//ending//'.svg"')
            call put(o, '   set multiplot layout 3,'//whole(count(is_there))//' title '//quoted(trim(m%title)) &
               //' font ",16"')
            do k = 0, 2
               call put(o, trim(merge('   set xlabel abscissa(over)', '   unset xlabel             ', k == 2)))
               do i = 1, 2
                  if (is_there(i)) call put_panel(o, m, table, own .and. table%columns%order == k, k, i == 2)
               end do
            end do
            call put(o, '   unset multiplot')
         end associate
      end subroutine put_page
   end subroutine put_script

   !> The panel of those of the columns `own` that are, or are not, `angular`: derivatives of order `k`. It is left
   !> empty where none of them has a value.
   subroutine put_panel(o, m, table, own, k, angular)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(table_t), intent(in) :: table
      logical, intent(in) :: own(:), angular
      integer, intent(in) :: k
      integer :: i, first, color

      first = findloc(own .and. (table%columns%angular .eqv. angular), .true., dim=1)
      call put(o, '   set ylabel '//quoted(phrase(merge(angle_words(k), length_words(k), angular), m%polish) &
         //' ['//unit_of(m, angular, k)//']'))
      call put(o, '   records = 0')
      call add(o, '   do for [c in "')
      do i = first, size(own)
         if (own(i) .and. (table%columns(i)%angular .eqv. angular)) call add(o, ' '//whole(number(i)))
      end do
      call put(o, '"] { if (records == 0) { stats table skip 1 using (column(int(c))) name "one" nooutput')
      call put(o, '      if (exists("one_records")) { records = one_records } } }')
      call put(o, '   if (records == 0) { set multiplot next } else {')
      call add(o, '      plot')
      do i = first, size(own)
         if (.not. own(i) .or. (table%columns(i)%angular .neqv. angular)) cycle
         color = 1 + mod(table%columns(i)%row - 1, page_rows)
         call put(o, ' table skip 1 using (column(over)):(column('//whole(number(i))//')) title ' &
            //quoted(trim(table%columns(i)%name))//' linetype '//whole(color)//' dashtype ' &
            //whole(merge(2, 1, table%columns(i)%coordinate == 2))//', \')
         call add(o, '          ')
      end do
      call put(o, ' for [side = -1:1:2] table skip 1 every ::0::0 using (column(over)):(column('//whole(number(first)) &
         //') + side*'//full(margin_of(m, angular, k))//') with lines linetype nodraw notitle')
      call put(o, '   }')

   contains

      !> The number in the table of column `i` of those after time and drives.
      pure integer function number(i)
         integer, intent(in) :: i

         number = 1 + size(table%drives) + i
      end function number
   end subroutine put_panel

   !> How far a panel reaches beyond the first value of its first column, at least: in the units of the deck.
   real(wp) function margin_of(m, angular, k)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: angular
      integer, intent(in) :: k
      real(wp) :: length

      length = characteristic_length(m)
      margin_of = least_height*characteristic_rate(m, length)**k
      if (.not. angular) margin_of = margin_of*length
      if (angular .and. m%degrees) margin_of = in_degrees(margin_of)
   end function margin_of

   !> The unit of a length or an angle, or of its derivative of order `k`.
   pure function unit_of(m, angular, k) result(unit)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: angular
      integer, intent(in) :: k
      character(:), allocatable :: unit

      unit = trim(m%length_unit)
      if (angular) unit = merge('DEG', 'RAD', m%degrees)
      if (k == 1) unit = unit//'/'//trim(m%time_unit)
      if (k == 2) unit = unit//'/'//trim(m%time_unit)//'**2'
   end function unit_of

   !> `text` as gnuplot takes it, the characters that mean something there by their octal numbers. Reason: in a block a
   !> string between apostrophes cannot begin with one, and between quotation marks backquotes start a command.
   pure function quoted(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = '"'
      do i = 1, len(text)
         select case (text(i:i))
         case ('"')
            word = word//'\042'
         case ('\')
            word = word//'\134'
         case ('`')
            word = word//'\140'
         case default
            word = word//text(i:i)
         end select
      end do
      word = word//'"'
   end function quoted
end module plot_script
